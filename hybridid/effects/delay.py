"""A delay as a Padé approximant with fixed poles: smooth in the delay, and no change of the signal at zero.

The poles of the textbook's approximant are proportional to 1 / delay and grow without bound as the delay
goes to zero. Here the denominator belongs to a fixed ``window`` W: ``D(x) = Σ d_k x^k`` of the [4/4]
approximant of exp(-x) at ``x = W s``. Only the numerator depends on the delay ``ρ W``: it is the Taylor
series of ``D(x) exp(-ρ x)``, truncated after x⁴. At ρ = 1 this is the textbook's approximant, at ρ = 0 it
is 1. In between, the numerator is a polynomial in ρ.

The states are the terms of the denominator, ``ζ_k = d_k W^k w^(k)`` with ``Σ ζ_k = u``. They have the
magnitude of u for any window. For a constant u only ζ_0 is not zero.

For 0 ≤ delay ≤ W the error is below 0.7 % of the amplitude up to 3 / W rad/s (48 Hz for 10 ms) and below
9 % up to 5 / W. So W is best a little larger than the delay. A trace tries ``WINDOW``, its half and its
quarter, keeps the one that explains most, and then sets it a little above the delay.
"""

from __future__ import annotations

from math import factorial

import casadi as ca

from hybridid.effects.dimension import EFFORT, TIME
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local
from hybridid.effects.paths import SETTLED

ORDER = 4
WINDOW = 0.01
"""Seconds."""


def _denominator(k: int, q: int = ORDER) -> float:
    """d_k of the [q/q] Padé approximant of exp(-x): (2q-k)! q! / ((2q)! k! (q-k)!)."""
    return factorial(2 * q - k) * factorial(q) / (factorial(2 * q) * factorial(k) * factorial(q - k))


D = tuple(_denominator(k) for k in range(ORDER + 1))


def _terms(at: Local) -> list[ca.SX]:
    """ζ_0 to ζ_4; the last is u minus the others."""
    zeta = [getattr(at.z, f"zeta_{k}") for k in range(ORDER)]
    return [*zeta, at.signal - sum(zeta)]


def _delayed_minus_signal(at: Local) -> ca.SX:
    """``Σ_k ζ_k Σ_{j<k} (d_j/d_k) (-ρ)^(k-j) / (k-j)!``, the approximant minus 1."""
    rho = at.p.delay / at.p.window
    total = ca.SX(0)
    for k, term in enumerate(_terms(at)):
        total += term * sum(D[j] / D[k] * (-rho) ** (k - j) / factorial(k - j) for j in range(k))
    return total


def _rates(at: Local) -> dict[str, ca.SX]:
    terms = _terms(at)
    return {f"zeta_{k}": D[k] / D[k + 1] * terms[k + 1] / at.p.window for k in range(ORDER)}


INPUT_DELAY = Effect(
    id="input_delay",
    kind="input",
    title="delay of the drive",
    equation=(
        "u → u(t - delay), as a Padé approximant [4/4] with the poles of the window,  ζ_0(0) = settled u(0)"
    ),
    law=_delayed_minus_signal,
    dynamics=_rates,
    parameters=(
        EffectParameter(
            "delay", TIME, "delay", guess=2e-3, lower=0.0, upper=WINDOW, nests=True, absolute=True
        ),
        EffectParameter(
            "window",
            TIME,
            "largest delay, fixed: a little larger than the delay",
            guess=WINDOW,
            starts=(WINDOW / 2, WINDOW / 4),
            lower=1e-9,
            fixed=True,
            absolute=True,
            above="delay",
        ),
        SETTLED,
    ),
    states=tuple(
        EffectState(
            f"zeta_{k}",
            EFFORT,
            f"term {k} of the approximant's denominator",
            follows=SETTLED.name if k == 0 else "",
        )
        for k in range(ORDER)
    ),
    source=(
        "Partington (2004), Some frequency-domain approaches to the model reduction of delay systems, "
        "Annual Reviews in Control 28(1), 65-73; its poles fixed as in hybridid.effects.delay"
    ),
    pattern=(
        "shifts the input's effect and leaves its shape; half a sampling time of it may be no physics but"
        " a hold that is declared wrongly"
    ),
    look_alikes=("input_lag", "sensor_lag", "stribeck"),
    separating_experiment=(
        "steps or a chirp of the command with content up to 1/(2π delay), sampled at least ten times "
        "faster than the delay: a delay shifts, a lag rounds and attenuates"
    ),
)
