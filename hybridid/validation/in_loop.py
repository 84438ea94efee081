"""A model inside the controller that ran the machine: outputs and control effort, beside the recorded ones.

A free run of a plant that integrates drifts, and a controller does not let it. In the loop a model is judged
as it will be used: how well the machine follows its reference, and what effort that takes. The controller
hides an error of the model in the outputs, and shows it in the effort.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.controllers.loop import Loop
from hybridid.model import Model
from hybridid.quantities import percent, quantity
from hybridid.records.record import Record
from hybridid.simulation.closed_loop import closed_loop
from hybridid.simulation.control_law import replayed
from hybridid.simulation.initial import measured_states, observed
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import substeps_for
from hybridid.validation.predict import Prediction, horizon_run

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Agreement:
    """What a control law makes of the recorded outputs of one ``record``, beside the recorded ``command``.

    ``rms`` is the RMS of their difference in ``unit``, ``share`` that over the RMS of the recorded command
    about its mean, ``most`` the largest share with which the law counts as the one that ran the machine.
    ``remark`` says why the record is not simulated in the loop. Where the law cannot be computed, rms and
    share are nan.
    """

    controller: str
    record: str
    provenance: str
    command: str
    unit: str
    rms: float
    share: float
    most: float
    remark: str = ""

    @property
    def said(self) -> str:
        """The share in words."""
        return percent(float(f"{self.share:.3g}"))

    @property
    def agrees(self) -> bool:
        """Whether the law is the one that ran the machine."""
        return self.share <= self.most


def synchronised(loop: Loop, record: Record) -> Loop:
    """``loop`` working at those samples where its law agrees best with the recorded commands: a law that
    works at each n-th sample need not begin with the first.

    Raises:
        ValueError: if the record lacks a signal of the law, or is too short for it.
    """
    phases = [replace(loop, phase=k) for k in range(loop.every)]
    return min(phases, key=lambda one: sum(found.share for found in agreement(one, record, np.inf)))


def agreement(loop: Loop, record: Record, most: float) -> tuple[Agreement, ...]:
    """What the law makes of the recorded outputs, for each of its commands, at the samples that count.

    Raises:
        ValueError: if the record lacks a signal of the law, or is too short for it.
        OwnCodeError: if the controller's code fails.
    """
    law, begin = loop.controller, loop.settled
    if begin >= record.n:
        raise ValueError(
            f"controller {law.name} must see {begin} samples, record {record.name} has {record.n}"
        )
    counts = record.counts & (np.arange(record.n) >= begin)
    if not counts.any():
        raise ValueError(f"controller {law.name}: the mask of record {record.name} leaves nothing to compare")
    found = []
    for command, said in zip(law.commands, replayed(loop, record).T, strict=True):
        recorded = record.input(command.name)[counts]
        rms = float(np.sqrt(np.mean((said[counts] - recorded) ** 2)))
        spread = float(recorded.std()) or float(np.abs(recorded).max())
        share = rms / spread if spread > 0 else (np.inf if rms > 0 else 0.0)
        where = (law.name, record.name, record.provenance, command.name, command.unit)
        found.append(Agreement(*where, rms, share, most))
    return tuple(replace(one, remark=disagreement(found) or "") for one in found)


def unknown_agreement(loop: Loop, record: Record, most: float, why: str) -> tuple[Agreement, ...]:
    """The same where the law cannot be computed, and ``why``."""
    law, nan = loop.controller, float("nan")
    return tuple(
        Agreement(law.name, record.name, record.provenance, one.name, one.unit, nan, nan, most, why)
        for one in law.commands
    )


def disagreement(found: Sequence[Agreement]) -> str | None:
    """Why the law is not the one that ran the machine, in words; None where it is."""
    apart = [one for one in found if not one.agrees]
    if not apart:
        return None
    said = "; ".join(
        f"the law's {one.command} differs by {quantity(one.rms, one.unit, 3)} RMS, {one.said} of "
        "the recorded one"
        for one in apart
    )
    return (
        f"controller {apart[0].controller} is not the law that ran record {apart[0].record}: with the "
        f"recorded outputs {said} (controller.tolerance: {percent(apart[0].most)})"
    )


def in_loop(
    model: Model,
    values: Mapping[str, float],
    record: Record,
    loop: Loop,
    horizon: int,
    initial_state: str = "estimated",
    integrator: str = "rk4",
    substeps: int | None = None,
) -> Prediction:
    """Simulate the whole record under the law of ``loop``; ``measured`` and ``predicted`` hold the outputs,
    then the commands that acted.

    States that are observed start where the first samples show them: a controller answers an error of its
    model there with an effort that no recording has. ``initial_state`` "estimated" starts the others where
    the first ``horizon`` samples are met best, "measured" at zero. ``substeps`` are the integration steps a
    sample. Masked samples are left out; a record ends at its first masked part that is not simulated.

    Raises:
        Diverged: if the simulation does not stay finite.
        ValueError: if the record lacks a signal of the model or of the law.
        OwnCodeError: if the controller's code fails.
    """
    begin, end = record.joined[0]
    masked, record = record.masked, record if end - begin == record.n else record.part(begin, end)
    kept = np.flatnonzero(record.counts) if masked else slice(None)
    p = model.values(values)
    steps = substeps or substeps_for(model, p, [record], integrator=integrator)
    x0, shown = measured_states(model, record)[0], np.array(observed(model))
    if initial_state == "estimated" and not shown.all():
        first = record.part(0, min(horizon, record.n))
        estimated = horizon_run(model, values, first, first.n, integrator, steps).initial_states[0]
        x0 = np.where(shown, x0, estimated)
    run = closed_loop(model, p, record, loop, x0, steps, integrator)
    predicted = np.hstack([run.outputs, run.commands])
    if not np.isfinite(predicted).all():
        at = int(np.argmin(np.isfinite(predicted).all(axis=1)))
        raise Diverged(f"record {record.name} diverged in the loop at t = {record.time[at]:.4g} s")
    signals = (*model.outputs, *loop.controller.commands)
    recorded = [record.input(one.name) for one in loop.controller.commands]
    return Prediction(
        record=record.name,
        view="loop",
        provenance=record.provenance,
        time=record.time[kept],
        measured=np.column_stack([record.measured, *recorded])[kept],
        predicted=predicted[kept],
        states=run.states[kept],
        output_names=tuple(s.name for s in signals),
        output_units=tuple(s.unit for s in signals),
        state_names=tuple(s.name for s in model.states),
        breaks=(begin,),
        initial_states=x0[None, :],
        rows=begin + np.arange(record.n)[kept] if masked else None,
    )
