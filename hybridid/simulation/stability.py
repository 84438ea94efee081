"""How many integration steps a sample needs to be stable and accurate."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.choices import Integrator
from hybridid.simulation.initial import observed
from hybridid.simulation.over_arrays import over_arrays
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.unobserved import filled_states
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]
Modes = NDArray[np.complex128]
T = TypeVar("T")
IMPLICIT: Integrator = "rodas3"
MOST = 50
"""Largest number of steps a sample; a stiffer model needs another integrator."""
COMFORTABLE = 1.0
"""|eigenvalue| times step that RK4 integrates, overdamped, with an error below 1 %."""
LIMIT = 2.78
"""|eigenvalue| times step above which RK4 is unstable. Source: Hairer, Wanner (1996), Solving Ordinary
Differential Equations II, sec. IV.2."""
STABLE = 1.5
"""The same for a value at few samples only, such as the slope of a friction near rest: RK4 still damps the
mode without oscillation, and its rate of decay at rest hardly matters."""
MOSTLY = 0.9
"""Share of the samples whose eigenvalues need accuracy; those of the others need stability only."""
LEAST_DAMPING = 0.02
"""Smallest damping ratio that is assumed of a mode: few records show fifty of its oscillations."""
RESOLVED = 2.0
"""Largest change of an eigenvalue within a step, times the step, for an implicit method."""
PROBES = 200
ACCURACY = 2e-4
"""Change of the outputs, in standard deviations, below which the step is not halved again."""
FAR = 1e6
"""Times the largest recorded output above which a simulated one is taken for an instability of the
integrator, though it is still a number: whether that overflows depends on the processor's last digits."""
HORIZON = 100
"""Samples over which the effect of a shorter step is computed."""
HORIZONS = 50


class TooStiff(ValueError):
    """A model would need more than ``MOST`` steps a sample."""


def substeps_for(
    model: Model, p: Array, records: Sequence[Record], margin: float = 1.0, integrator: str = "rk4"
) -> int:
    """Steps a sample with which ``integrator`` is stable and accurate at ``p`` (n_p,).

    ``margin`` is a safety factor, 1 or more.

    Raises:
        TooStiff: if more than ``MOST`` steps would be needed.
        ValueError: if there is no such integrator.
    """
    return _checked(substeps_wanted(model, p, records, margin, integrator), integrator)


def substeps_to_predict(model: Model, p: Array, records: Sequence[Record], integrator: str = "rk4") -> int:
    """As ``substeps_for``, for a prediction, which needs no derivatives.

    A kink within a step of an implicit method spoils the derivative of the step more than its end. Where
    ``MOST`` steps do not resolve the kink, they do for a prediction if half as many give the same outputs.

    Raises:
        ValueError: as ``substeps_for``.
    """
    steps = substeps_wanted(model, p, records, integrator=integrator)
    if steps > MOST and integrator == IMPLICIT:
        paths = [filled_states(model, p, record) for record in records]
        half, most = (_outputs(model, p, records, paths, n) for n in (MOST // 2, MOST))
        steps = MOST if _change(half, most) <= ACCURACY else steps
    return _checked(steps, integrator)


def in_enough_steps(run: Callable[[int], T], is_plausible: Callable[[T], bool], steps: int) -> T:
    """``run(steps)``; where that is not plausible, in twice as many steps a sample until it is, and twice as
    many once more: what is only just stable is not accurate. In ``MOST`` at most.

    A record does not show how fast a model becomes that leaves it, or between two samples.
    """
    found = run(steps)
    while not is_plausible(found) and 2 * steps <= MOST:
        steps *= 2
        found = run(steps)
        if is_plausible(found):
            return run(2 * steps) if 2 * steps <= MOST else found
    return found


def stays_near(outputs: Array, record: Record) -> bool:
    """Whether simulated ``outputs`` (n, n_y) are ``near`` the recorded ones at every sample."""
    return bool(near(outputs, record).all())


def near(outputs: Array, record: Record) -> NDArray[np.bool_]:
    """At which samples (n,) simulated ``outputs`` (n, n_y) are finite, and none is above ``FAR`` times the
    largest recorded one (unless all of these are zero)."""
    limit = FAR * float(np.abs(np.nan_to_num(record.outputs)).max(initial=0.0))
    return np.asarray((np.abs(outputs) <= (limit or np.finfo(float).max)).all(axis=1))


def _checked(steps: int, integrator: str) -> int:
    if steps > MOST:
        raise TooStiff(REMEDY[integrator].format(most=MOST))
    return steps


def first_substeps(model: Model, p: Array, records: Sequence[Record], integrator: str) -> int:
    """Steps a sample for a fit that starts at ``p``: stable there with a margin of 10 %.

    Whether they are accurate enough is checked at the end of the fit.

    Raises:
        ValueError: as ``substeps_for``.
    """
    if integrator == IMPLICIT:
        paths = [filled_states(model, p, record) for record in records]
        return min(by_kinks(model, p, records, paths), MOST)
    return substeps_for(model, p, records, 1.1, integrator)


def substeps_wanted(
    model: Model,
    p: Array,
    records: Sequence[Record],
    margin: float = 1.0,
    integrator: str = "rk4",
    paths: Sequence[Array] | None = None,
) -> int:
    """As ``substeps_for``, but ``MOST + 1`` instead of an error for more than ``MOST``.

    ``paths`` are approximate states (n, n_x) at each record's samples: along these it is the number itself,
    however large. None: ``filled_states``. There, states that no output shows are simulated in one step a
    sample, which may be far off where they are fast. So what is too stiff along that path is asked once more
    along one that is simulated in ``MOST`` steps.

    Raises:
        ValueError: if there is no such integrator.
    """
    if integrator not in RULES:
        raise ValueError(f"unknown integrator {integrator!r}: known: {', '.join(RULES)}")
    if paths is not None:
        return RULES[integrator](model, p, records, paths, margin)
    kept: dict[str, _Wanted] = model.kept("steps wanted", dict)
    last = kept.get(integrator)
    if last is None or not last.answers(p, records, margin):
        found = _along_the_record(model, p, records, margin, integrator, 1)
        if found > MOST and not all(observed(model)):
            found = _along_the_record(model, p, records, margin, integrator, MOST)
        last = kept[integrator] = _Wanted(np.array(p), tuple(map(ref, records)), margin, found)
    return last.steps


def _along_the_record(
    model: Model, p: Array, records: Sequence[Record], margin: float, integrator: str, substeps: int
) -> int:
    """Steps a sample, ``MOST + 1`` at most, along the states that the records show, the others simulated in
    ``substeps`` a sample."""
    paths = [filled_states(model, p, record, substeps) for record in records]
    return min(RULES[integrator](model, p, records, paths, margin), MOST + 1)


@dataclass(frozen=True)
class _Wanted:
    """The last answer about a model and an integrator: a fit asks twice where it begins and where it ends."""

    p: Array
    records: tuple[ref[Record], ...]
    margin: float
    steps: int

    def answers(self, p: Array, records: Sequence[Record], margin: float) -> bool:
        """Whether it was asked for these."""
        same = len(self.records) == len(records) and margin == self.margin and np.array_equal(p, self.p)
        return same and all(own() is one for own, one in zip(self.records, records, strict=True))


def by_eigenvalues(
    model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array], margin: float
) -> int:
    """Steps that keep ``|λ| h`` below ``COMFORTABLE ζ^(1/4) / margin`` for the modes λ of most samples.

    RK4 has an error of ``|λ h|⁵/120`` of a mode in a step, which accumulates over ``1 / (ζ |λ| h)`` steps,
    with ζ = -Re λ / |λ|: a lightly damped resonance needs shorter steps than a decay. At all samples, also
    at rest, ``|λ| h`` is below ``STABLE / margin``.
    """
    needed = 1.0
    for record, (moving, resting) in zip(records, _modes(model, p, records, paths), strict=True):
        size = np.abs(moving)
        damping = np.divide(-moving.real, size, out=np.ones_like(size), where=size > 0)
        accurate = np.quantile((size / np.clip(damping, LEAST_DAMPING, 1) ** 0.25).max(axis=1), MOSTLY)
        stable = max(size.max(), np.abs(resting).max())
        needed = max(needed, record.dt * margin * max(accurate / COMFORTABLE, stable / STABLE))
    return int(np.ceil(needed))


def by_kinks(model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array]) -> int:
    """Steps within which an eigenvalue changes by less than ``RESOLVED / h``.

    An implicit method is stable at any step. But if the slope of a friction jumps within a step (sign(v) near
    rest), the derivative of the step is wrong, and shooting needs that derivative. Such a kink is stiffer at
    rest than in motion. A growing mode needs short steps, too.
    """
    needed = 1.0
    for record, (moving, resting) in zip(records, _modes(model, p, records, paths), strict=True):
        kink = np.abs(resting).max() - np.median(np.abs(moving).max(axis=1))
        growth = max(moving.real.max(), resting.real.max())
        needed = max(needed, record.dt * kink / RESOLVED, record.dt * growth / (0.25 * RESOLVED))
    return int(np.ceil(needed))


def by_halving(
    model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array], margin: float
) -> int:
    """Steps, doubled until doubling them changes the outputs by less than ``ACCURACY / margin``.

    An implicit method is stable at any step, so the accuracy of the outputs decides. They are compared
    over up to ``HORIZONS`` short horizons, each from a state of ``paths``.
    """
    steps = by_kinks(model, p, records, paths)
    if steps > MOST:
        return steps
    before = _outputs(model, p, records, paths, steps)
    while steps <= MOST:
        after = _outputs(model, p, records, paths, 2 * steps)
        if _change(before, after) <= ACCURACY / margin:
            return steps
        steps, before = 2 * steps, after
    return steps


Rule = Callable[[Model, Array, Sequence[Record], Sequence[Array], float], int]
RULES: Mapping[str, Rule] = {
    "rk4": by_eigenvalues,
    "rodas3": by_halving,
}
"""The rule for the number of steps, by integrator."""
REMEDY: Mapping[str, str] = {
    "rk4": "the model is too stiff for RK4, which would need more than {most} steps a sample: "
    "set estimator.integrator to rodas3, raise the port's epsilon or lower a stiffness",
    "rodas3": "the model is too fast for these records: {most} steps a sample do not resolve it; "
    "raise the port's epsilon or lower a stiffness",
}


def _modes(
    model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array]
) -> list[tuple[Modes, Modes]]:
    """Eigenvalues of df/dx in 1/s at some samples of each record, (m, n_x), and at rest, (m, n_x)."""
    chosen = [_probed(record) for record in records]
    t = np.concatenate([record.time[k] for record, k in zip(records, chosen, strict=True)])
    x = np.concatenate([path[k] for path, k in zip(paths, chosen, strict=True)])
    u = np.concatenate([record.inputs[k] for record, k in zip(records, chosen, strict=True)])
    slopes, n_x = model.kept("slopes", lambda: over_arrays(model.by_state)), x.shape[1]

    def eigenvalues(states: Array) -> Modes:
        (entries,) = slopes([[t], list(states.T.copy()), list(u.T.copy()), list(p)])
        stacked = np.array([np.broadcast_to(entry, t.shape) for entry in entries])
        matrices = stacked.reshape(n_x, n_x, len(t)).T
        return np.linalg.eigvals(np.where(np.isfinite(matrices), matrices, 0.0)).astype(complex)

    ends = np.cumsum([len(k) for k in chosen])[:-1]
    moving, resting = (np.split(eigenvalues(states), ends) for states in (x, np.zeros_like(x)))
    return list(zip(moving, resting, strict=True))


def _probed(record: Record) -> NDArray[np.intp]:
    """Numbers of up to ``PROBES`` samples that count, evenly chosen."""
    counting = np.flatnonzero(record.counts) if record.masked else np.arange(record.n)
    return counting[np.linspace(0, len(counting) - 1, min(PROBES, len(counting))).astype(int)]


def _outputs(model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array], steps: int) -> Array:
    """Outputs over the horizons that are compared, each from its sample's state, (w, H, n_y)."""
    windows = cut(records, HORIZON, steps, HORIZONS)
    x0 = np.stack([paths[index][start] for index, start, _ in windows.origin])
    return Shooter(model, windows, integrator=IMPLICIT)(x0, p).outputs


@np.errstate(over="ignore", invalid="ignore")  # too few steps may diverge
def _change(before: Array, after: Array) -> float:
    """RMS difference of the outputs over their standard deviation in the horizons; 0 if they are constant."""
    difference = np.sqrt(np.mean((after - before) ** 2, axis=(0, 1)))
    spread = np.sqrt(np.mean((after - after[:, :1]) ** 2, axis=(0, 1)))
    ratio = np.divide(difference, spread, out=np.zeros_like(spread), where=spread > 0)
    return float(np.max(ratio)) if np.isfinite(ratio).all() else np.inf
