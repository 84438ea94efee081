"""Friction in series with a play: a friction element that is reached only when the gap is crossed.

Friction in series with a spring alone is ``dahl`` or ``bouc_wen`` (with sigma = 1/2 and a large n, Jenkins'
element), so this module has the play only.
"""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, POSITION
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local
from hybridid.effects.smooth import dead_zone


def _pull(at: Local) -> ca.SX:
    """Effort over the friction level: 0 within the play, up to ±1 where the friction slips."""
    return dead_zone(at.z.x, at.p.g, at.p.width) / at.p.s


def _travel(at: Local) -> ca.SX:
    """``x' = v - (|v| N + v |N|) / 2``: x follows the port, and stops at |N| = 1 while it is pulled on."""
    pull = _pull(at)
    return at.velocity - 0.5 * (ca.fabs(at.velocity) * pull + at.velocity * ca.fabs(pull))


FRICTION_BEHIND_PLAY = Effect(
    id="friction_behind_play",
    kind="effort",
    title="friction behind a play",
    equation=(
        "F = f_c N,  N = (x - sat(x, g))/s: 0 within the play ±g, then up to ±1 over s;  x' = v - (|v| N + v "
        "|N|)/2"
    ),
    law=lambda at: at.p.f_c * _pull(at),
    dynamics=lambda at: {"x": _travel(at)},
    parameters=(
        EffectParameter("f_c", EFFORT, "friction level behind the play", guess=0.1, lower=0.0, nests=True),
        EffectParameter(
            "g", POSITION, "half the play", guess=0.02, lower=1e-3, upper=1.0, starts=(5e-3, 0.1)
        ),
        EffectParameter(
            "s",
            POSITION,
            "length over which the friction builds up once the play is crossed",
            guess=5e-3,
            lower=5e-4,
            upper=1.0,
            minor=True,
        ),
        EffectParameter("width", POSITION, "rounding of the play's edges", guess=1e-4, lower=0.0, fixed=True),
    ),
    states=(EffectState("x", POSITION, "position of the port in the play", scale=0.02),),
    source=(
        "the dead zone of Nordin, Gutman (2002), Automatica 38(10), 1633-1649, in series with the friction "
        "of Wen (1976), ASCE J. Engineering Mechanics Division 102(2), 249-263, sigma = 1/2 and n = 1"
    ),
    pattern=(
        "after each reversal no friction over the play, whatever the speed, then the whole of it; swings "
        "smaller than the play meet none. Dahl friction starts at once, free play belongs to a spring"
    ),
    look_alikes=("bouc_wen", "dahl", "backlash", "free_play", "coulomb"),
    separating_experiment=(
        "slow strokes of growing amplitude: below the play the loop has no area, above it two flat branches"
        " with a free travel of twice g after each reversal"
    ),
)
