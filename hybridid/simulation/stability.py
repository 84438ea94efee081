"""How many integration steps a sample needs to be stable and accurate."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.unobserved import filled_states
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]
Modes = NDArray[np.complex128]
IMPLICIT = "rodas3"
MOST = 50
"""A model stiffer than this many steps a sample wants another integrator."""
COMFORTABLE = 1.0
"""|eigenvalue| times step that RK4 integrates, overdamped, with an error below 1 %; its limit is 2.78."""
STABLE = 1.5
"""The same where it is met only now and then, as the slope of a friction near rest: RK4 still damps
without ringing, and how fast a stuck machine stops creeping matters less than that it does."""
MOSTLY = 0.9
"""Share of the samples that ask for accuracy, the others for stability."""
LEAST_DAMPING = 0.02
"""A mode damped less than this counts as damped so: few records show fifty swings of one."""
RESOLVED = 2.0
"""Change of an eigenvalue, times the step, that an implicit method's derivatives follow."""
PROBES = 200
ACCURACY = 2e-4
"""Change of the outputs, in standard deviations, below which halving the step is no use."""
HORIZON = 100
"""Samples over which the effect of a shorter step is looked at."""
HORIZONS = 50


def substeps_for(
    model: Model, p: Array, records: Sequence[Record], margin: float = 1.0, integrator: str = "rk4"
) -> int:
    """Steps a sample with which ``integrator`` is stable and accurate at ``p`` (n_p,).

    ``margin`` above 1 asks for that much more.

    Raises:
        ValueError: if more than ``MOST`` steps would be needed, or there is no such integrator.
    """
    steps = substeps_wanted(model, p, records, margin, integrator)
    if steps > MOST:
        raise ValueError(REMEDY[integrator].format(most=MOST))
    return steps


def first_substeps(model: Model, p: Array, records: Sequence[Record], integrator: str) -> int:
    """Steps a sample for a fit that starts at ``p``: stable there, with a tenth in hand.

    Whether they are accurate enough shows where the fit ends.

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
    """As ``substeps_for``, but ``MOST + 1`` for whatever is more than ``MOST``.

    ``paths`` are the states (n, n_x) of each record's samples, about; None: ``filled_states``.

    Raises:
        ValueError: if there is no such integrator.
    """
    if integrator not in RULES:
        raise ValueError(f"unknown integrator {integrator!r}: known: {', '.join(RULES)}")
    if paths is None:
        paths = [filled_states(model, p, record) for record in records]
    return min(RULES[integrator](model, p, records, paths, margin), MOST + 1)


def by_eigenvalues(
    model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array], margin: float
) -> int:
    """Steps that keep ``|λ| h`` below ``COMFORTABLE ζ^(1/4) / margin`` for the modes λ of most samples.

    RK4 misses ``|λ h|⁵/120`` of a mode in a step, and a mode remembers ``1 / (ζ |λ| h)`` steps, with
    ζ = -Re λ / |λ|: a lightly damped resonance needs shorter steps than a decay. Everywhere, also at
    rest, ``|λ| h`` stays below ``STABLE / margin``.
    """
    needed = 1.0
    for record, path in zip(records, paths, strict=True):
        moving, resting = _modes(model, p, record, path)
        size = np.abs(moving)
        damping = np.divide(-moving.real, size, out=np.ones_like(size), where=size > 0)
        accurate = np.quantile((size / np.clip(damping, LEAST_DAMPING, 1) ** 0.25).max(axis=1), MOSTLY)
        stable = max(size.max(), np.abs(resting).max())
        needed = max(needed, record.dt * margin * max(accurate / COMFORTABLE, stable / STABLE))
    return int(np.ceil(needed))


def by_kinks(model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array]) -> int:
    """Steps within which an eigenvalue changes by less than ``RESOLVED / h``.

    An implicit method is stable at any step, but where a friction's slope jumps within one (sign(v)
    near rest), the derivative of the step means nothing, and shooting needs it. Such a kink is
    stiffer at rest than in motion; a mode that grows needs resolving too.
    """
    needed = 1.0
    for record, path in zip(records, paths, strict=True):
        moving, resting = _modes(model, p, record, path)
        kink = np.abs(resting).max() - np.median(np.abs(moving).max(axis=1))
        growth = max(moving.real.max(), resting.real.max())
        needed = max(needed, record.dt * kink / RESOLVED, record.dt * growth / (0.25 * RESOLVED))
    return int(np.ceil(needed))


def by_halving(
    model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array], margin: float
) -> int:
    """Steps, doubled until doubling them moves the outputs by less than ``ACCURACY / margin``.

    An implicit method is stable at any step, so only what the outputs show decides. They
    are compared over up to ``HORIZONS`` short horizons, each from a state of ``paths``.
    """
    steps = by_kinks(model, p, records, paths)
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
"""How each integrator's steps are chosen."""
REMEDY: Mapping[str, str] = {
    "rk4": "the model is too stiff for RK4, which would need more than {most} steps a sample: "
    "set estimator.integrator to rodas3, raise the port's epsilon or lower a stiffness",
    "rodas3": "the model is too fast for these records: {most} steps a sample do not resolve it; "
    "raise the port's epsilon or lower a stiffness",
}


def _modes(model: Model, p: Array, record: Record, path: Array) -> tuple[Modes, Modes]:
    """Eigenvalues of df/dx in 1/s at some samples of a record, (m, n_x), and at rest, (m, n_x)."""
    k = np.unique(np.linspace(0, record.n - 1, PROBES).astype(int))
    states, many = path[k], model.by_state.map(len(k))

    def eigenvalues(at: Array) -> Modes:
        stacked = many(record.time[k], at.T, record.inputs[k].T, np.tile(p, (len(k), 1)).T)
        matrices = np.asarray(stacked).reshape(at.shape[1], len(k), at.shape[1]).swapaxes(0, 1)
        return np.linalg.eigvals(np.where(np.isfinite(matrices), matrices, 0.0)).astype(complex)

    return eigenvalues(states), eigenvalues(np.zeros_like(states))


def _outputs(model: Model, p: Array, records: Sequence[Record], paths: Sequence[Array], steps: int) -> Array:
    """Outputs over the horizons that are compared, each from its sample's state, (w, H, n_y)."""
    windows = cut(records, HORIZON, steps)
    windows = windows.select(np.unique(np.linspace(0, windows.count - 1, HORIZONS).astype(int)).tolist())
    x0 = np.stack([paths[index][start] for index, start, _ in windows.origin])
    return Shooter(model, windows, integrator=IMPLICIT)(x0, p).outputs


def _change(before: Array, after: Array) -> float:
    """RMS difference of the outputs over their deviation within the horizons; 0 if they stand still."""
    difference = np.sqrt(np.mean((after - before) ** 2, axis=(0, 1)))
    spread = np.sqrt(np.mean((after - after[:, :1]) ** 2, axis=(0, 1)))
    ratio = np.divide(difference, spread, out=np.zeros_like(spread), where=spread > 0)
    return float(np.max(ratio)) if np.isfinite(ratio).all() else np.inf
