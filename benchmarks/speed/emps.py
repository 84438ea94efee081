"""The EMPS' identification record, as our ``fit`` takes it and as the ``Task`` of the other ways."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.rivals import Task
from hybridid.estimators import FitSettings, fit
from hybridid.estimators.method import MENDING
from hybridid.estimators.problem import build_problem
from hybridid.estimators.start import regression_start
from hybridid.estimators.stop import Stop
from hybridid.model import Model
from hybridid.records.record import Channel, Record
from hybridid.signals.steps import apply_steps
from hybridid_cli.composing import settings_of
from pipelines.shared.modelling import model_of
from pipelines.shared.sources import sources_of

Array = NDArray[np.float64]
DT = 1e-3
NAMES = ("M", "carriage.viscous.f_v", "carriage.coulomb.f_c", "carriage.offset.offset")
"""The parameters in the order of a ``Task``."""


@dataclass(frozen=True)
class Contested:
    """A fit that all ways do, from measured initial states: horizons of so many samples (None: the whole)."""

    model: Model
    records: tuple[Record, ...]
    horizon: int | None

    def ours(self) -> Array:
        """The parameters of our fit as it comes: start, descent, check of the steps, standard errors, what
        noise and simulation leave and, where the fit leaves more, a second descent from elsewhere."""
        settings = FitSettings(horizon=self.horizon, initial_state="measured")
        found = fit(self.model, self.records, settings)
        return np.array([found.values[name] for name in NAMES])

    def alone(self) -> Array:
        """The parameters of one descent from our start, as the other ways find them: nothing that a fit finds
        out besides."""
        start = regression_start(self.model, self.records)
        assert start is not None
        problem = build_problem(self.model, self.records, self.horizon, 1, estimate_x0=False)
        settings = FitSettings()
        stop = Stop(settings.max_iterations, settings.tolerance)
        x0 = problem.measured_x0()
        found = MENDING.solve(problem, start, x0, settings.continuation, stop)
        values = dict(zip((p.name for p in self.model.parameters), found.p, strict=True))
        return np.array([values[name] for name in NAMES])

    def task(self) -> Task:
        """The same fit for the other ways."""
        problem = build_problem(self.model, self.records, self.horizon, 1)
        windows, order = problem.windows, [s.name for s in self.model.states]
        declared = {p.name: p for p in self.model.parameters}
        own = [declared[name] for name in NAMES]
        used = np.asarray(windows.used)
        position = np.zeros(used.shape)
        for row, (record, start, stop) in zip(position, windows.origin, strict=True):
            row[: stop - start] = self.records[record].outputs[start:stop, 0]
        return Task(
            dt=windows.dt,
            force=np.ascontiguousarray(windows.inputs[:, :, 0]),
            position=position,
            used=used,
            x0=problem.measured_x0()[:, [order.index("v"), order.index("q")]],
            epsilon=declared["carriage.epsilon"].guess,
            guess=np.array([p.guess for p in own]),
            lower=np.array([p.lower for p in own]),
            upper=np.array([p.upper for p in own]),
            scale=np.array([p.scale for p in own]),
        )


def contested(horizon: int | None, *words: str) -> Contested:
    """The case's own identification record and model; ``words`` as on the command line."""
    settings = settings_of(["case=emps", *words])
    source = next(s for s in sources_of(settings).found if s.role == "identification")
    record = apply_steps(source.record(), settings["preprocess.steps"])
    return Contested(model_of(settings), (record,), horizon)


def like_emps(samples: int, seed: int = 0) -> Record:
    """So many samples at 1 kHz of a simulated EMPS under a position controller, with 10 µm of noise.

    The friction is the declared one. The rig of the case, with friction that sticks, takes longer to simulate
    than to fit.
    """
    draw = np.random.default_rng([seed, samples])
    time, reference = DT * np.arange(samples), np.zeros(samples)
    for period in (0.9, 2.3, 5.7):
        reference += 0.05 * np.sin(2 * np.pi * time / period + draw.uniform(0, 2 * np.pi))
    force, position = _controlled(reference)
    return Record(
        name=f"run_{seed}",
        time=time,
        inputs=force[:, None],
        outputs=(position + 1e-5 * draw.standard_normal(samples))[:, None],
        input_channels=(Channel("force", "N", "zoh"),),
        output_channels=(Channel("position", "m"),),
        simulated=True,
        source=f"benchmark of the speed, seed {seed} (simulated)",
    )


@numba.njit(cache=False)
def _controlled(reference: Array) -> tuple[Array, Array]:
    """Force [N] and position [m] of 95 kg with 200 N s/m, 20 N and an offset of -3 N behind a PD controller,
    in ten steps a sample."""
    force, position = np.empty_like(reference), np.empty_like(reference)
    q, v, h = reference[0], 0.0, DT / 10
    for k in range(len(reference)):
        position[k] = q
        force[k] = 2e4 * (reference[k] - q) - 2e3 * v
        for _ in range(10):
            v += h * (force[k] - 200 * v - 20 * np.tanh(v / 3e-4) + 3) / 95
            q += h * v
    return force, position
