"""The integrator of the rigs: Dormand-Prince 5(4) between events, with dry friction that sticks exactly.

Each contact slides in one direction (slip +1 or -1) or sticks (0). While no slip changes, the motion is
smooth, and adaptive steps of order five follow it. An event ends a step early: a sliding contact comes to
rest, or a sticking one can no longer be held. Bisection of the step length finds it. A contact with dry
friction then

    sticks        if F(0-) <= holding force <= F(0+)
    slides up     if holding force > F(0+)
    slides down   if holding force < F(0-)

where F(0+-) are the limits of the contact's laws at rest, and the holding force is the force that keeps it
at rest. No velocity is smoothed and nothing creeps. A contact without dry friction reverses its direction.

This is one file, because numba's cache does not notice a change in another one.

Source: Hairer, Norsett, Wanner (1993), "Solving ordinary differential equations I", Tables II.5.2 and
Section II.6 (discontinuities); Karnopp (1985), J. Dyn. Sys. Meas. Control 107 (sticking).
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (numba infers the types of the functions below: numbers, and arrays of float64)

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

_MAX_STEPS = 100_000
_BISECTIONS = 60
_C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_ERROR = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


class Tables(NamedTuple):
    """A ``Machine`` as flat arrays; the state is y = (q, q', states of the laws).

    Law k acts at ``contact[k]``; its states and parameters start at ``state_start[k]`` and
    ``parameter_start[k]``. Contact c can stick if ``dry[c]``; its direction matters if ``sided[c]``. Law k
    sees the contact's drive and load if ``loaded[k]``, and is part of the loads if ``carried[k]``.
    """

    inverse_mass: NDArray[np.float64]
    input_matrix: NDArray[np.float64]
    directions: NDArray[np.float64]
    dry: NDArray[np.bool_]
    sided: NDArray[np.bool_]
    laws: Any
    contact: NDArray[np.int64]
    state_start: NDArray[np.int64]
    parameter_start: NDArray[np.int64]
    parameters: NDArray[np.float64]
    loaded: NDArray[np.bool_]
    carried: NDArray[np.bool_]


@njit(cache=True)
def _dot(a, b):
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@njit(cache=True)
def _law(m, k, t, y, slip, p, dy):
    """Force of law k with the parameters ``p``; fills its rates in ``dy``."""
    n, c = m.inverse_mass.shape[0], m.contact[k]
    z = slice(2 * n + m.state_start[k], 2 * n + m.state_start[k + 1])
    q, v = _dot(m.directions[c], y[:n]), _dot(m.directions[c], y[n : 2 * n])
    return m.laws[k](t, q, v, slip[c], y[z], p, dy[z])


@njit(cache=True)
def _own(m, k):
    return m.parameters[m.parameter_start[k] : m.parameter_start[k + 1]]


@njit(cache=True)
def _with_load(m, k, t, u, y, slip, dy):
    """Parameters of law k, then the drive and the load along its contact, both positive in its direction."""
    along, own = m.directions[m.contact[k]], _own(m, k)
    p = np.zeros(len(own) + 2)
    p[: len(own)] = own
    length = _dot(along, along)
    for i in range(len(along)):
        p[-2] += along[i] * _dot(m.input_matrix[i], u) / length
    for j in range(len(m.laws)):
        if m.carried[j]:
            share = _dot(along, m.directions[m.contact[j]]) / length
            p[-1] -= share * _law(m, j, t, y, slip, _own(m, j), dy)
    return p


@njit(cache=True)
def _resistance(m, t, u, y, slip, dy):
    """Force of each contact's laws at these slips, shape (c,); fills the laws' rates in ``dy``."""
    force = np.zeros(len(slip))
    for k in range(len(m.laws)):
        p = _with_load(m, k, t, u, y, slip, dy) if m.loaded[k] else _own(m, k)
        force[m.contact[k]] += _law(m, k, t, y, slip, p, dy)
    return force


@njit(cache=True)
def _sticks(m, slip, c):
    return m.dry[c] and slip[c] == 0.0


@njit(cache=True)
def _compliance(m, slip):
    """D M^-1 D^T between the sticking contacts, and 1 on the diagonal of the others; shape (c, c)."""
    compliance = np.zeros((len(slip), len(slip)))
    for c in range(len(slip)):
        compliance[c, c] = 1.0
        for d in range(len(slip)):
            if _sticks(m, slip, c) and _sticks(m, slip, d):
                compliance[c, d] = _dot(m.directions[c], _push(m, d))
    return compliance


@njit(cache=True)
def _solve(a, b):
    """Solve a x = b by elimination, overwriting both; ``a`` is positive definite and needs no pivots.

    numba needs seconds to compile numpy's solver.
    """
    for c in range(len(b)):
        for d in range(len(b)):
            if d != c and a[d, c] != 0.0:
                ratio = a[d, c] / a[c, c]
                b[d] -= ratio * b[c]
                for k in range(c, len(b)):
                    a[d, k] -= ratio * a[c, k]
    for c in range(len(b)):
        b[c] /= a[c, c]
    return b


@njit(cache=True)
def _hold(m, slip, acceleration):
    """Cancel the acceleration along every sticking contact; return the holding forces, shape (c,)."""
    along = np.zeros(len(slip))
    for c in range(len(slip)):
        if _sticks(m, slip, c):
            along[c] = _dot(m.directions[c], acceleration)
    held = _solve(_compliance(m, slip), along)
    for c in range(len(slip)):
        if _sticks(m, slip, c):
            push = _push(m, c)
            for i in range(len(push)):
                acceleration[i] -= push[i] * held[c]
    return held


@njit(cache=True)
def _push(m, c):
    """Acceleration of the coordinates by a unit force along contact c, shape (n,)."""
    out = np.empty(m.inverse_mass.shape[0])
    for i in range(len(out)):
        out[i] = _dot(m.inverse_mass[i], m.directions[c])
    return out


@njit(cache=True)
def _derivative(m, t, u, y, slip, dy):
    """Fills ``dy``; returns the holding forces, shape (c,)."""
    n = m.inverse_mass.shape[0]
    resistance = _resistance(m, t, u, y, slip, dy)
    drive = np.zeros(n)
    for i in range(n):
        drive[i] = _dot(m.input_matrix[i], u)
        for c in range(len(slip)):
            if not _sticks(m, slip, c):
                drive[i] -= m.directions[c, i] * resistance[c]
    for i in range(n):
        dy[i] = y[n + i]
        dy[n + i] = _dot(m.inverse_mass[i], drive)
    return _hold(m, slip, dy[n : 2 * n])


@njit(cache=True)
def _step(m, t, h, u, y, slip, tolerance):
    """One step: the new state, its error over the tolerance, the holding forces at its end."""
    size = len(y)
    k = np.zeros((7, size))
    new, hold = np.empty(size), np.empty(0)
    for stage in range(7):
        for i in range(size):
            new[i] = y[i] + h * _dot(_A[stage, :stage], k[:stage, i])
        hold = _derivative(m, t + _C[stage] * h, u, new, slip, k[stage])
    error = 0.0
    for i in range(size):
        allowed = tolerance * (0.01 + max(abs(y[i]), abs(new[i])))
        local = abs(h * _dot(_ERROR, k[:, i])) / allowed
        error = max(error, local if np.isfinite(local) else np.inf)
    return new, error, hold


@njit(cache=True)
def _excess(m, t, u, y, hold, slip):
    """Holding force beyond the limit of each sticking contact, shape (c,): positive to slide up."""
    scratch, tried = np.empty(len(y)), slip.copy()
    excess = np.zeros(len(slip))
    for c in range(len(slip)):
        if _sticks(m, slip, c):
            tried[c] = 1.0
            up = _resistance(m, t, u, y, tried, scratch)[c]
            tried[c] = -1.0
            down = _resistance(m, t, u, y, tried, scratch)[c]
            tried[c] = 0.0
            excess[c] = max(hold[c] - up, 0.0) + min(hold[c] - down, 0.0)
    return excess


@njit(cache=True)
def _speed(m, y, c):
    n = m.inverse_mass.shape[0]
    return _dot(m.directions[c], y[n : 2 * n])


@njit(cache=True)
def _changes(m, t, u, y, hold, slip):
    """Which contacts must stop sliding or sticking, shape (c,), and whether there are any."""
    changed = _excess(m, t, u, y, hold, slip) != 0.0
    some = False
    for c in range(len(slip)):
        if not m.sided[c]:
            continue
        speed = _speed(m, y, c)
        if slip[c] * speed < 0.0 or (slip[c] == 0.0 and speed != 0.0 and not m.dry[c]):
            changed[c] = True
        some = some or changed[c]
    return changed, some


@njit(cache=True)
def _release(m, t, u, y, slip):
    """Release the sticking contacts that cannot be held, the most overloaded first."""
    scratch = np.empty(len(y))
    for _ in range(len(slip)):
        excess = _excess(m, t, u, y, _derivative(m, t, u, y, slip, scratch), slip)
        worst = 0
        for c in range(len(slip)):
            if abs(excess[c]) > abs(excess[worst]):
                worst = c
        if excess[worst] == 0.0:
            return
        slip[worst] = np.sign(excess[worst])


@njit(cache=True)
def _arrest(m, y, slip, changed):
    """Set the velocity of the dry sliding contacts that changed to exactly zero; reverse the others."""
    n = m.inverse_mass.shape[0]
    for c in range(len(slip)):
        if changed[c] and not m.dry[c]:
            slip[c] = np.sign(_speed(m, y, c))
        elif changed[c] and slip[c] != 0.0:
            push = _push(m, c)
            impulse = _speed(m, y, c) / _dot(m.directions[c], push)
            for i in range(n):
                y[n + i] -= push[i] * impulse
            slip[c] = 0.0


@njit(cache=True)
def _event_step(m, t, h, u, y, slip, tolerance):
    """The shortest step within ``h`` after which some contact has changed."""
    before, after = 0.0, h
    for _ in range(_BISECTIONS):
        middle = 0.5 * (before + after)
        new, _, hold = _step(m, t, middle, u, y, slip, tolerance)
        if _changes(m, t + middle, u, new, hold, slip)[1]:
            after = middle
        else:
            before = middle
    return after


@njit(cache=True)
def advance(
    start, duration, u, y, slip, tolerance, max_step,
    inverse_mass, input_matrix, directions, dry, sided, laws, contact, state_start, parameter_start,
    parameters, loaded, carried,
):  # fmt: skip
    """Integrate over ``duration`` [s] with ``u`` constant, in place; return the number of events, or -1.

    The fields of ``Tables`` come one by one because numba takes 50 us to look at a tuple from Python.
    """
    m = Tables(
        inverse_mass, input_matrix, directions, dry, sided, laws, contact, state_start, parameter_start,
        parameters, loaded, carried,
    )  # fmt: skip
    elapsed, events, h = 0.0, 0, min(duration, max_step)
    _release(m, start, u, y, slip)
    for _ in range(_MAX_STEPS):
        left = duration - elapsed
        if left <= 1e-15 * max(1.0, start):
            return events
        h = min(h, left)
        new, error, hold = _step(m, start + elapsed, h, u, y, slip, tolerance)
        if not error <= 1.0:
            h *= max(0.2, 0.9 * error**-0.2) if error < np.inf else 0.2
            continue
        step = h
        changed, some = _changes(m, start + elapsed + h, u, new, hold, slip)
        if some:
            step = _event_step(m, start + elapsed, h, u, y, slip, tolerance)
            new, _, hold = _step(m, start + elapsed, step, u, y, slip, tolerance)
            changed, _ = _changes(m, start + elapsed + step, u, new, hold, slip)
        elapsed += step
        for i in range(len(y)):
            y[i] = new[i]
        if some:
            events += 1
            _arrest(m, y, slip, changed)
            _release(m, start + elapsed, u, y, slip)
        h = min(max_step, h * min(5.0, 0.9 * max(error, 1e-10) ** -0.2))
    return -1
