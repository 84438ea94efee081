"""Gray-box fits: ours beside other ways, from bad starts, and of more samples, recordings, parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.contest import Way, contest
from benchmarks.speed.emps import Contested, contested, like_emps
from benchmarks.speed.rivals import Task, by_every_sample, by_numba, by_solve_ivp
from benchmarks.speed.row import OURS, Row, rows_of
from hybridid.estimators import FitSettings, fit
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.residuals.rbf import RBFNetwork

Say = Callable[[str], None]
BESIDE = "gray-box fit beside other ways"
GROWING = "gray-box fit of more data and parameters"
RIVALS = {
    "least_squares, numba RK4": by_numba,
    "every sample a node, IPOPT": by_every_sample,
    "least_squares, solve_ivp": by_solve_ivp,
}
SLOW = {"every sample a node, IPOPT", "least_squares, solve_ivp"}
BAD = (0.4, 2.5)
"""The guesses times one of these, in turn, inside the bounds: bad starts."""


def beside(repeats: int, say: Say, quick: bool) -> Iterator[Row]:
    """The EMPS' identification record: free run and horizons of 1 s, from the guesses and from bad starts."""
    for what, horizon in (("EMPS, free run", None), ("EMPS, horizons of 1 s", 1000)):
        own = contested(horizon)
        for start, one in ((what, own), (f"{what}, bad start", _badly_started(own))):
            say(start)
            task = one.task()
            fast = [name for name in RIVALS if not (quick and name in SLOW)]
            rivals = [Way(name, partial(RIVALS[name], task), slow=name in SLOW) for name in fast]
            found = contest([Way(OURS, one.ours), *rivals], repeats, say)
            yield from rows_of(BESIDE, start, found, own.records[0].provenance, partial(_reached, task))


def _reached(task: Task, p: NDArray[np.float64]) -> str:
    """The parameters that a way found, judged by one simulation for all ways."""
    return f"RMSE {1e3 * task.rmse(p):.6f} mm, M = {p[0]:.3f} kg"


def _badly_started(own: Contested) -> Contested:
    moved = dict(own.model.adjustments)
    for k, p in enumerate(own.model.free):
        guess = float(np.clip(p.guess * BAD[k % 2], p.lower, p.upper))
        moved[p.name] = {"guess": guess, "lower": p.lower, "upper": p.upper}
    return replace(own, model=replace(own.model, adjustments=moved))


def growing(repeats: int, say: Say, quick: bool) -> Iterator[Row]:
    """A simulated EMPS, horizons of 1 s, measured initial states."""
    most = 1 if quick else 100
    for times in (1, 10, 100):
        if times <= most:
            whole = [like_emps(25_000 * times)]
            yield from _ours(f"{whole[0].n:,} samples", whole, repeats if times < 100 else 1, say)
    for count in (1, 12, 100):
        if count <= max(most, 12):
            runs = [like_emps(5_000, seed) for seed in range(count)]
            yield from _ours(f"{count} recordings of 5,000 samples", runs, repeats, say)
    record = [like_emps(25_000)]
    yield from _ours("1 parameter", record, repeats, say, _only_the_mass)
    yield from _ours("19 parameters", record, repeats, say, _with_a_network)


def _ours(
    what: str, records: list[Record], repeats: int, say: Say, change: Callable[[Model], Model] = lambda m: m
) -> Iterator[Row]:
    say(what)
    model = change(contested(1000, "data=simulated").model)

    def run() -> str:
        found = fit(model, records, FitSettings(horizon=1000, initial_state="measured"))
        free = len(model.free)
        return f"cost {found.cost:.6g}, {free} free, {found.iterations} iterations, {found.status}"

    yield from rows_of(GROWING, what, contest([Way(OURS, run)], repeats, say), "simulated")


def _only_the_mass(model: Model) -> Model:
    known = {p.name: {"fixed": p.guess} for p in model.free if p.name != "M"}
    return replace(model, adjustments={**model.adjustments, **known})


def _with_a_network(model: Model) -> Model:
    """Four parameters, and five radial basis functions of the velocity with three each."""
    network = RBFNetwork(5, (-0.3, 0.3), "velocity")
    return model.plus(network.effect(model.plant.port("carriage")), "carriage")
