"""Simulated carriages that hide something, horizons of them, and a trace that found nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from hybridid.effects.library import effect_named
from hybridid.model import Model
from hybridid.records.record import Channel, Record
from hybridid.simulation.simulate import simulate
from hybridid.trace.context import Context
from hybridid.trace.entries import Floor, Level, TriedEffect
from hybridid.trace.horizons.split import Split, by_record
from hybridid.trace.results.result import Estimates, LearnedGains, Trace
from hybridid.trace.rules import Rules
from hybridid.trace.verdict import Conclusion, conclude

Array = NDArray[np.float64]
HORIZON = 50  # samples, 0.25 s
NOISE = 2e-6  # m
LOUD = 1e-4  # m


@pytest.fixture(scope="session")
def two_records(carriage_like, noise) -> Callable[..., tuple[Record, Record]]:
    """``two_records(df_v=80)``: a carriage's run, and one noisier, with less force, backwards and slower."""

    def make(std: float = NOISE, n: int = 800, **truth: float) -> tuple[Record, Record]:
        carriage = carriage_like(**truth)

        class Reversed(carriage_like):
            def force(self, time: Array) -> Array:
                return self.offset - 0.9 * (super().force(0.9 * time) - self.offset)

            def temperature(self, time: Array) -> Array:
                return 50 - super().temperature(1.3 * time)

        other = Reversed(**truth)
        first = carriage.record(n, noise=noise(n, std, seed=1), name="first")
        return first, other.record(n, noise=noise(n, std, seed=2), name="second")

    return make


@pytest.fixture(scope="session")
def split_of(two_records) -> Callable[..., Split]:
    """Fitted on the first record, judged on the second."""

    def make(**given: float) -> Split:
        first, second = two_records(**given)
        return by_record([first], [second], HORIZON)

    return make


@pytest.fixture(scope="session")
def larger_than_fitted(carriage_like, noise) -> Callable[..., Split]:
    """``larger_than_fitted(seed, df_v=60)``: fitted on a noisy run of a carriage without Coulomb friction,
    judged on one that moves twenty times as far, with a noise of ``judged`` m."""

    class Larger(carriage_like):
        def force(self, time: Array) -> Array:
            return 20.0 * super().force(time)

    def make(seed: int = 0, judged: float = 0.0, **truth: float) -> Split:
        given = {"f_c": 0.0, "offset": 0.0, **truth}
        first = carriage_like(**given).record(400, noise=noise(400, LOUD, seed=seed), name="first")
        second = Larger(**given).record(400, noise=noise(400, judged, seed=99), name="larger")
        return by_record([first], [second], HORIZON)

    return make


@pytest.fixture(scope="session")
def held_as() -> Callable[..., Record]:
    """A record whose force is assumed to run otherwise between samples."""

    def make(record: Record, hold: str) -> Record:
        return replace(record, input_channels=(Channel("force", "N", hold, assumed=True),))

    return make


@pytest.fixture(scope="session")
def decided() -> list[str]:
    """The lines that the trace ``worn`` says of its steps."""
    return []


@pytest.fixture(scope="session")
def worn_context(split_of, decided) -> Context:
    """A carriage whose friction differs by direction, by 80 N s/m, and six effects to try."""
    frictions = ("stribeck", "asymmetric_viscous", "asymmetric_coulomb", "quadratic_drag")
    tried = tuple(map(effect_named, (*frictions, "cubic_stiffness", "input_gain")))
    return Context(split_of(df_v=80.0), tried, say=decided.append, variables=("velocity", "position"))


@pytest.fixture(scope="session")
def worn(make_model, worn_context) -> Conclusion:
    """Its trace."""
    return conclude(make_model(), worn_context)


@pytest.fixture
def nothing() -> Callable[..., Trace]:
    """Builds a trace that names nothing, of the effects it tried."""

    def build(*rejected: TriedEffect, stopped: str = "no further effect passes") -> Trace:
        return Trace(
            provenance="simulated",
            verdict="nothing_missing",
            sentence="",
            accepted=(),
            rejected=rejected,
            before=(),
            after=(),
            noise_floor={"position": Floor(2e-6, "m", 1e-6)},
            seconds=1.0,
            declared=(),
            effects=(),
            estimates=Estimates({}, {}),
            path=(Level("declared model", {"position": 3e-6}, {}, 1.0),),
            ceilings=LearnedGains((), ()),
            remains=(),
            times=1.0,
            times_fitted=1.0,
            refused="",
            completeness=None,
            stopped=stopped,
            withdrawn="",
            split="",
            horizon=1.0,
            horizons=(4, 4),
            rules=Rules(),
            records=(),
            steps=(),
        )

    return build


@pytest.fixture(scope="session")
def split_by_model(two_records, noise) -> Callable[[Model, Mapping[str, float]], Split]:
    """Records that a model itself makes of the two inputs, fitted on the first and judged on the second."""

    def make(model: Model, values: Mapping[str, float]) -> Split:
        records = []
        for seed, record in enumerate(two_records()):
            run = simulate(model, values, record, substeps=10)
            noisy = run.outputs + noise(len(record.time), NOISE, seed)[:, None]
            records.append(replace(record, outputs=noisy))
        return by_record(records[:1], records[1:], 2 * HORIZON)

    return make
