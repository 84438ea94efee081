"""Gray-box fits: ours beside other ways, from bad starts, and of more samples, recordings, parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from math import nan

import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.contest import Way, contest
from benchmarks.speed.emps import Contested, contested, like_emps
from benchmarks.speed.rivals import Task, by_every_sample, by_jax_sysid, by_numba, by_solve_ivp
from benchmarks.speed.row import OURS, Row, rows_of
from hybridid.effects.library import effect_named
from hybridid.estimators import FitSettings, fit
from hybridid.model import Model
from hybridid.naming import counted
from hybridid.records.record import Record
from hybridid.residuals.rbf import RBFNetwork

Say = Callable[[str], None]
BESIDE = "gray-box fit beside other ways"
GROWING = "gray-box fit of more data and parameters"
RIVALS = {
    "least_squares, numba RK4": by_numba,
    "every sample a node, IPOPT": by_every_sample,
    "least_squares, solve_ivp": by_solve_ivp,
    "jax-sysid": by_jax_sysid,
}
SLOW = {"every sample a node, IPOPT", "least_squares, solve_ivp", "jax-sysid"}
OPTIONAL = {"jax-sysid": "jax_sysid"}
"""Ways by libraries that we do not require, and the modules that they need."""
ALONE = f"{OURS}, parameters alone"
"""Ours without what the others do not find: standard errors, what noise leaves, a second descent."""
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
            absent = [name for name in fast if name in OPTIONAL and find_spec(OPTIONAL[name]) is None]
            there = [name for name in fast if name not in absent]
            rivals = [Way(name, partial(RIVALS[name], task), slow=name in SLOW) for name in there]
            own_ways = [Way(OURS, one.ours), Way(ALONE, one.alone)]
            found = contest([*own_ways, *rivals], repeats, say)
            provenance = own.records[0].provenance
            yield from rows_of(BESIDE, start, found, provenance, partial(_reached, task))
            yield from (Row(BESIDE, start, name, (nan,), "not installed", provenance) for name in absent)


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
    longer = ((times, [like_emps(25_000 * times)]) for times in (1, 10, 100) if times <= most)
    yield from _beside_first(
        _ours(f"{whole[0].n:,} samples", whole, repeats if times < 100 else 1, say) for times, whole in longer
    )
    counts = [count for count in (1, 12, 100) if count <= max(most, 12)]
    more = ((count, [like_emps(25_000, seed) for seed in range(count)]) for count in counts)
    yield from _beside_first(
        _ours(f"{counted(count, 'recording')} of 25,000 samples", runs, repeats, say) for count, runs in more
    )
    record = [like_emps(25_000)]
    for what, change in MODELS.items():
        yield _ours(what, record, repeats, say, change)


def _ours(
    what: str, records: list[Record], repeats: int, say: Say, change: Callable[[Model], Model] = lambda m: m
) -> Row:
    say(what)
    model = change(contested(1000, "data=simulated").model)

    def run() -> tuple[float, int, str]:
        found = fit(model, records, FitSettings(horizon=1000, initial_state="measured"))
        return found.cost, found.iterations, found.status

    (timed,) = contest([Way(OURS, run)], repeats, say)
    cost, iterations, status = timed.found
    reached = f"cost {cost:.6g}, {len(model.free)} free, {iterations} iterations, {status}"
    size = {"samples": float(sum(r.n for r in records)), "iterations": float(iterations)}
    return Row(GROWING, what, OURS, timed.seconds, reached, "simulated", timed.memory, details=size)


def _beside_first(rows: Iterable[Row]) -> Iterator[Row]:
    """With each row's seconds a sample over those of the first row: 1 where the time is linear."""
    first: Row | None = None
    for row in rows:
        first = first or row
        each = [one.median / one.details["samples"] for one in (row, first)]
        yield replace(
            row, details={**row.details, "seconds a sample over the first row's": each[0] / each[1]}
        )


def _only_the_mass(model: Model) -> Model:
    known = {p.name: {"fixed": p.guess} for p in model.free if p.name != "M"}
    return replace(model, adjustments={**model.adjustments, **known})


def _with_one_effect(model: Model) -> Model:
    return model.plus(effect_named("asymmetric_viscous"), "carriage")


def _with_a_network(model: Model) -> Model:
    """Five parameters, and five radial basis functions of the velocity with three each."""
    network = RBFNetwork(5, (-0.3, 0.3), "velocity")
    return _with_one_effect(model).plus(network.effect(model.plant.port("carriage")), "carriage")


MODELS: dict[str, Callable[[Model], Model]] = {
    "1 parameter": _only_the_mass,
    "5 parameters": _with_one_effect,
    "20 parameters": _with_a_network,
}
