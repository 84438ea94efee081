"""The rivals: what a careful practitioner does today, and PySINDy, on the same records.

``regression``: inverse dynamics on the library's own terms. The candidate whose grid point lowers the
identification residual is taken in if a Wald test with HAC errors gives p < 0.001 and the held-out residual
falls by 2 % or more; of those that pass within 2 % of the lowest held-out residual, the one with the fewest
parameters; then again, up to ``MOST`` times. An amplitude outside its bounds is no finding. Three ways: at
50 Hz (200 Hz where the machine rings at 68 Hz, 20 Hz on a road) with memoryless terms, at the cutoff that
the record suggests, and at that with terms of memory as well, their inner states computed along the
smoothed motion.  Its class is what it named: a regression knows no classes.

``pysindy``: the acceleration (of machines of one mass; else as the regression) on the input, the declared
terms and the candidates at the library's guesses and starts, sequentially thresholded least squares
(``pysindy.STLSQ``, normalised columns), the threshold chosen on the held-out record, the sparsest within 2 %
of the best. Its dictionary is without effects that have inner states: PySINDy takes functions of what is
measured, and with such columns, all nearly alike, it names worse.
"""

from __future__ import annotations

import functools
import time
import warnings
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from benchmarks.league.answer import Answer
from benchmarks.league.columns import DEGENERATE, Term, columns, terms
from benchmarks.league.machines import CASES
from benchmarks.league.scenario import Scenario
from benchmarks.league.signals import Equation, equation
from hybridid.model import Model
from hybridid.records.record import Record

Array = NDArray[np.float64]
LOWEST = 5.0  # Hz, the least cutoff that a record may suggest
CUTOFF = {"oscillator": 200.0, "half_car": 20.0}  # Hz, above what moves; of all others
USUAL = 50.0  # Hz
ABOVE = 4.0  # times its noise floor: what a spectrum must reach to count as signal
SIGNIFICANT, WORTH, MOST = 1e-3, 0.02, 3
MEMORY = 0.1  # s, over which HAC errors allow residuals to correlate
THRESHOLDS = np.geomspace(1e-3, 1.0, 25)
NEAR = 1.02
ONE_MASS = ("carriage", "carriage_open", "carriage_level", "oscillator")


@dataclass(frozen=True)
class Data:
    """Regression of one record on what has been taken in: ``y`` (n,), ``x`` (n, k), rows that count, scaled
    so that every equation weighs the same."""

    equation: Equation
    weight: Array
    y: Array
    x: Array

    @classmethod
    def of(cls, eq: Equation) -> Data:
        rows = eq.y.reshape(-1, len(eq.time))
        size = [row.std() or rows[0].std() for row in rows]  # an equation without a left side: as the first
        weight = 1 / np.repeat(size, len(eq.time))[eq.keep]
        return cls(eq, weight, eq.y[eq.keep] * weight, eq.base[eq.keep] * weight[:, None])

    @property
    def solved_for_acceleration(self) -> Data:
        """``a = u / M - ...``: the first column for y, and y for the first column."""
        return replace(self, y=self.x[:, 0], x=np.column_stack([self.y, self.x[:, 1:]]))

    def column(self, made: Array) -> Array:
        return made[self.equation.keep] * self.weight[:, None]

    def plus(self, made: Array) -> Data:
        return replace(self, x=np.column_stack([self.x, self.column(made)]))


def regression(
    scenario: Scenario, records: tuple[Record, Record], cutoff: float | None = None, memory: bool = False
) -> Answer:
    """Inverse-dynamics regression with forward selection."""
    return _selected(scenario.machine, records, cutoff or _usual(scenario), memory)


@functools.lru_cache(maxsize=1)
def _selected(machine: str, records: tuple[Record, Record], cutoff: float, memory: bool) -> Answer:
    began = time.process_time()
    model = CASES[machine].model()
    first, second = (Data.of(equation(machine, record, cutoff)) for record in records)
    base = start = _held_out(first, second)
    taken: list[Term] = []
    values: dict[str, float] = {}
    theta = np.linalg.lstsq(first.x, first.y, rcond=None)[0]
    declared = theta[: first.equation.base.shape[1]]
    groups = _candidates(model, first, declared, memory)
    for _ in range(MOST):
        found = _best(model, groups, first, second, declared, {t.name for t in taken}, base)
        if found is None:
            break
        term, base, first, second, amplitude = found
        taken.append(term)
        values = values or {**dict(term.shape), **amplitude}
    return Answer(
        player="regression",
        named=tuple(term.name for term in taken),
        alike=tuple(term.name for term in taken[:1]),
        values=values,
        before=start,
        after=base,
        seconds=time.process_time() - began,
    )


def _usual(scenario: Scenario) -> float:
    return CUTOFF.get(scenario.machine, USUAL)


def own_cutoff(scenario: Scenario, records: tuple[Record, Record]) -> Answer:
    """The regression at the cutoff that the record suggests: where its outputs sink into their noise."""
    cutoff = _own(scenario, records)
    return replace(
        regression(scenario, records, cutoff), player="regression_own_cutoff", notes={"cutoff": cutoff}
    )


def with_memory(scenario: Scenario, records: tuple[Record, Record]) -> Answer:
    """At that cutoff, and with terms whose inner state is computed along the smoothed motion."""
    cutoff = _own(scenario, records)
    found = regression(scenario, records, cutoff, memory=True)
    return replace(found, player="regression_memory", notes={"cutoff": cutoff})


def _own(scenario: Scenario, records: tuple[Record, Record]) -> float:
    seen = min(_seen_to(y, records[0].dt) for y in records[0].outputs.T)
    return float(np.clip(seen, LOWEST, _usual(scenario)))


def _seen_to(y: Array, dt: float) -> float:
    """The highest frequency [Hz] up to which ``y`` (n,) stands above its noise.

    The floor is the median of its spectral density over the highest quarter of frequencies.
    """
    frequency, density = welch(y, 1 / dt, nperseg=min(512, len(y) // 4), detrend="linear")
    floor = np.median(density[-len(density) // 4 :])
    below = np.flatnonzero(density < ABOVE * floor)
    return float(frequency[below[0] if len(below) else -1])


def _held_out(first: Data, second: Data) -> float:
    theta = np.linalg.lstsq(first.x, first.y, rcond=None)[0]
    return _error(second, theta)


def _error(data: Data, theta: Array) -> float:
    """Root mean square of what ``theta`` leaves, over the regressand's own."""
    return float(np.sqrt(np.mean((data.y - data.x @ theta) ** 2) / np.mean(data.y**2)))


def _candidates(model: Model, first: Data, declared: Array, memory: bool) -> list[list[tuple[Term, Array]]]:
    """Every candidate with its columns (n, m) on the identification record, effect by effect."""
    groups: dict[str, list[tuple[Term, Array]]] = {}
    for term in terms(model, first.equation, memory=memory):
        made = first.column(columns(term, first.equation, declared, model.plant.port(term.port)))
        if np.isfinite(made).all():
            groups.setdefault(term.name, []).append((term, made))
    return list(groups.values())


def _best(model: Model, groups, first: Data, second: Data, declared: Array, taken: set[str], base: float):
    """Of the candidates that pass, the one with the lowest held-out residual; None where none does."""
    passed = []
    q, _ = np.linalg.qr(first.x)
    rest = first.y - q @ (q.T @ first.y)
    for group in groups:
        if group[0][0].name in taken:
            continue
        term, made = group[int(np.argmin([_left(made, q, rest) for _, made in group]))]
        port = model.plant.port(term.port)
        theirs = columns(term, second.equation, declared, port)
        added, judged = replace(first, x=np.column_stack([first.x, made])), second.plus(theirs)
        held_out = _held_out(added, judged)
        if held_out > (1 - WORTH) * base:
            continue
        p, coefficients = _wald(added, made.shape[1])
        own = [q.at(port) for q in term.effect.parameters if q.nests]
        within = term.effect.kind != "effort" or all(
            a.lower <= c <= a.upper for a, c in zip(own, coefficients, strict=True)
        )
        if p < SIGNIFICANT and within:
            amplitude = dict(zip((a.name for a in own), map(float, coefficients), strict=True))
            passed.append((held_out, term, added, judged, amplitude))
    if not passed:
        return None
    near = (1 + WORTH) * min(one[0] for one in passed)
    alike = [one for one in passed if one[0] <= near]
    held_out, term, added, judged, amplitude = min(alike, key=lambda one: (_parameters(one[1]), one[0]))
    return term, held_out, added, judged, amplitude


def _parameters(term: Term) -> int:
    return sum(not p.fixed for p in term.effect.parameters)


def _left(made: Array, q: Array, rest: Array) -> float:
    """Sum of squares that columns leave of ``rest``, what the base with orthonormal columns ``q`` leaves;
    infinite where they add nothing new."""
    if _nothing_new(made, q):
        return float("inf")
    new = made - q @ (q.T @ made)
    inside, *_ = np.linalg.lstsq(new.T @ new, new.T @ rest, rcond=1e-12)
    return float(rest @ rest - inside @ (new.T @ rest))


def _wald(data: Data, count: int) -> tuple[float, Array]:
    """HAC p-value that the last ``count`` coefficients are all zero, and these coefficients."""
    import statsmodels.api as sm

    lags = round(MEMORY / data.equation.dt)
    fit = sm.OLS(data.y, data.x).fit(cov_type="HAC", cov_kwds={"maxlags": lags})
    picked = np.eye(data.x.shape[1])[-count:]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # two columns that are one: the test then counts them once
        p = float(fit.wald_test(picked, scalar=True).pvalue)
    return (p if np.isfinite(p) else 1.0), fit.params[-count:]


def pysindy(scenario: Scenario, records: tuple[Record, Record], cutoff: float | None = None) -> Answer:
    """Sequentially thresholded least squares over declared and candidate terms."""
    began = time.process_time()
    model = CASES[scenario.machine].model()
    first, second = (
        Data.of(equation(scenario.machine, record, cutoff or _usual(scenario))) for record in records
    )
    theta = np.linalg.lstsq(first.x, first.y, rcond=None)[0]
    if scenario.machine in ONE_MASS:
        first, second = first.solved_for_acceleration, second.solved_for_acceleration
    names = [""] * first.x.shape[1]
    start = _held_out(first, second)
    q, _ = np.linalg.qr(first.x)
    for term in terms(model, first.equation, coarse=True, memory=False):
        if term.effect.id == "input_gain":  # beside the inertias it would make up the regressand itself
            continue
        port = model.plant.port(term.port)
        ours, theirs = (columns(term, d.equation, theta, port) for d in (first, second))
        if not np.isfinite(theirs).all() or _nothing_new(first.column(ours), q):
            continue
        names += [term.name] * ours.shape[1]
        first_x, second_x = first.plus(ours), second.plus(theirs)
        first, second = first_x, second_x
    coefficients = _thresholded(first, second)
    size = np.abs(coefficients) * first.x.std(axis=0)
    order = [int(k) for k in np.argsort(-size) if names[k] and size[k] > 0]
    named = tuple(dict.fromkeys(names[k] for k in order))
    return Answer(
        player="pysindy",
        named=named,
        alike=named[:1],
        before=start,
        after=_error(second, coefficients),
        seconds=time.process_time() - began,
        notes={"terms": len(named)},
    )


def _nothing_new(made: Array, q: Array) -> bool:
    """Whether columns (n, m) are not finite, or one with those that ``q`` (n, k) spans."""
    if not np.isfinite(made).all():
        return True
    new = made - q @ (q.T @ made)
    return bool((np.linalg.norm(new, axis=0) <= DEGENERATE * np.linalg.norm(made, axis=0)).all())


def _thresholded(first: Data, second: Data) -> Array:
    """Coefficients (k,) at the threshold that the held-out record prefers."""
    from pysindy import STLSQ

    size = np.linalg.norm(first.x, axis=0)
    scale = np.linalg.norm(first.y) or 1.0
    q, r = np.linalg.qr(first.x / size)  # the same least squares in as many rows as there are columns
    y = q.T @ first.y / scale
    found: list[tuple[float, int, Array]] = []
    for threshold in THRESHOLDS:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            optimiser = STLSQ(threshold=threshold, alpha=1e-9, max_iter=20)
            optimiser.fit(r, y[:, None])
        coefficients = np.asarray(optimiser.coef_).ravel() * scale / size
        left = _error(second, coefficients)
        found.append((left, int(np.count_nonzero(coefficients)), coefficients))
    best = min(left for left, _, _ in found)
    return min((one for one in found if one[0] <= NEAR * best), key=lambda one: one[1])[2]
