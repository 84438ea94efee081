"""Starts for a pitch, a frequency or the place of a stop, found by a search in the record.

The cost has many local minima over such a parameter, and a descent stays in the one where it starts. So the
effect is set to zero at each value of a grid, and the decrease of the cost that one Gauss-Newton step
predicts there (a score test) shows where the effect would help. The highest peaks of the grid become starts.
This only chooses where refits begin; the refits decide. The frequency of a disturbance is read from the
spectrum of the residual; that of a resonance is sought on a grid, as what a load does to the motion need not
be the strongest line there. A load behind a play resonates too, while its contact is closed: so its frequency
is sought with a play no wider than the error that is left.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hybridid.effects.effect import EffectParameter
from hybridid.estimators.carried import carries_nothing
from hybridid.estimators.problem import Problem
from hybridid.estimators.reduced import promise
from hybridid.model import Model
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refit_starts import begin, problem_of
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.limit_starts import with_limit_exceeded
from hybridid.trace.starts.load_starts import (
    FASTEST,
    narrow_play,
    sought_by,
    with_closed_contact,
    with_half_the_inertia,
)
from hybridid.trace.starts.order_spectrum import pitches

Array = NDArray[np.float64]
PEAKS = 2
"""Of a grid or a spectrum that become starts."""
PERIODS, PLACES, RESONANCES = 40, 16, 16
"""Most periods within the visited range, places along it, and frequencies of a resonance in a decade that are
tried."""
SLOWEST = 3.0
"""Periods of a resonance in the longest record, at least."""
GRIDS = ("period", "place", "frequency")
"""What is sought on a grid or in a spectrum."""
LOOKED_AT = 10
"""Fitted horizons by which a grid is judged."""


def sought(candidate: Candidate, model: Model, base: Refit, split: Split) -> list[dict[str, float]]:
    """Further starts of the augmented ``model``, beside ``Candidate.starts``; none for most effects."""
    found = [
        start
        for parameter in candidate.effect.parameters
        if parameter.sought in GRIDS
        for start in _starts(candidate, parameter, model, base, split)
    ]
    with_play = bool(sought_by(candidate, "play"))  # its half inertia begins with every width of the play
    without_load = candidate.starts(model, base.values) if with_play or not found else found
    loaded = with_half_the_inertia(candidate, without_load, base, split)
    closed = with_closed_contact(candidate, model, base, split)
    return [*found, *loaded, *closed, *with_limit_exceeded(candidate, model, split)]


def known_means(candidate: Candidate, model: Model, split: Split) -> dict[str, float]:
    """The parameters of the effect that are the mean over the records of the channel it sees."""
    names = [p.name for p in candidate.effect.parameters if p.sought == "mean"]
    if not names:
        return {}
    column = [signal.name for signal in model.inputs].index(candidate.effect.channels[0])
    seen = np.concatenate([record.inputs[:, column] for record in split.records])
    return {f"{candidate.name}.{name}": float(seen.mean()) for name in names}


def _starts(
    candidate: Candidate, parameter: EffectParameter, model: Model, base: Refit, split: Split
) -> Iterator[dict[str, float]]:
    name = f"{candidate.name}.{parameter.name}"
    declared = parameter.at(model.plant.port(candidate.port))
    at_nothing = {**candidate.starts(model, base.values)[0], **narrow_play(candidate, model, base)}
    path = Path.of(base, split, split.fitted)
    if parameter.sought == "frequency" and not candidate.effect.states:
        for value in _spectral_peaks(base, split, path):
            if declared.lower <= value <= declared.upper:
                yield {**at_nothing, name: value}
        return
    if parameter.sought == "frequency":
        grid = _frequencies(split)
    else:
        visited = path.place(candidate.port)
        grid = _grid(parameter, float(visited.min()), float(visited.max()))
        if parameter.sought == "period" and candidate.effect.kind == "effort":
            fine = pitches(base, split, candidate.port, PERIODS)
            grid = np.sort(np.concatenate([grid, fine]))[::-1]
    grid = grid[(grid >= declared.lower) & (grid <= declared.upper)]
    for variant in _variants(candidate, model, at_nothing):
        signed = grid if variant.get(f"{candidate.name}.side", 1.0) > 0 else -grid
        promised = _promised(model, base, split, [{**variant, name: float(v)} for v in signed])
        for k in _peaks(promised):
            yield {**variant, name: float(signed[k])}


def _variants(candidate: Candidate, model: Model, start: dict[str, float]) -> Iterator[dict[str, float]]:
    """``start``, and with each alternative of a fixed parameter (the side of a stop)."""
    yield start
    for parameter in candidate.effect.parameters:
        if parameter.fixed:
            for value in parameter.starts_at(model.plant.port(candidate.port)):
                yield {**start, f"{candidate.name}.{parameter.name}": value}


def _grid(parameter: EffectParameter, low: float, high: float) -> Array:
    span = high - low
    if parameter.sought == "place":
        return np.linspace(low, high, PLACES + 2)[1:-1]
    # what tells two periods apart is half a period over the whole range
    return span / np.arange(0.5, PERIODS, 0.5) if span > 0 else np.empty(0)


def _frequencies(split: Split) -> Array:
    """Those of a resonance [Hz], from ``SLOWEST`` periods a record on: its inner states are handed on from
    horizon to horizon."""
    dt, longest = split.records[0].dt, max(record.n for record in split.records)
    slow, fast = SLOWEST / longest, max(FASTEST, 2.0 / split.horizon)
    return np.geomspace(slow, fast, round(RESONANCES * math.log10(fast / slow))) / dt


def _promised(model: Model, base: Refit, split: Split, starts: list[dict[str, float]]) -> Array:
    """The cost's promised decrease from each of ``starts``, which differ by one parameter alone."""
    if not starts:
        return np.empty(0)
    problem = problem_of(model, split, base, starts[len(starts) // 2])
    rows = _looked_at(split, problem)
    first = begin(problem, problem.model.values(starts[0]), base, base.numerics)
    part = problem.on(rows)
    found = []
    for start in starts:
        p = problem.smoothed(problem.model.values(start), base.numerics.smoothing)
        found.append(promise(part, p, first.x0[rows]))
    return np.array(found)


def _looked_at(split: Split, problem: Problem) -> list[int]:
    """Some fitted horizons, evenly chosen; one after the other where they hand on inner states."""
    step = max(1, len(split.fitted) // LOOKED_AT) if carries_nothing(problem) else 1
    return list(split.fitted[::step][:LOOKED_AT])


def _spectral_peaks(base: Refit, split: Split, path: Path) -> list[float]:
    """Frequencies [Hz] of the strongest peaks in the spectra of the errors, record by record."""
    problem = base.problem(split).on(split.fitted)
    errors = problem.residuals(problem.shooter(base.x0[list(split.fitted)], path.p))
    used = problem.windows.used
    series = np.concatenate([row[kept] for row, kept in zip(errors, used, strict=True)])
    series = (series - series.mean(axis=0)) * np.hanning(len(series))[:, None]
    power = (np.abs(np.fft.rfft(series, axis=0)) ** 2).sum(axis=1)
    frequencies = np.fft.rfftfreq(len(series), problem.windows.dt)
    # slower than a horizon its own initial state takes it up
    power[frequencies < 1.0 / (split.horizon * problem.windows.dt)] = 0.0
    return [float(frequencies[k]) for k in _peaks(power)]


def _peaks(values: Array) -> list[int]:
    """The highest local maxima of (n,), the highest first; ends count."""
    padded = np.concatenate([[-np.inf], np.nan_to_num(values, nan=-np.inf), [-np.inf]])
    inner = padded[1:-1]
    maxima = np.flatnonzero((inner > 0) & (inner >= padded[:-2]) & (inner >= padded[2:]))
    return sorted(maxima.tolist(), key=lambda k: -inner[k])[:PEAKS]
