"""Whether a law is a function of one of its variables, times a function of all others.

A law F(s, w) is separable in the variable s if F = f(s) g(w). Then, for any two places (s, w) and (s', w'),

    F(s, w) F(s', w') = F(s, w') F(s', w).

Coulomb friction that grows with the load, mu |L| sign(v), is so in the velocity, with f = sign(v), and in the
load. A torque ripple, a D sin(n q), is so in the position, and in the drive D.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import SimpleNamespace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.effects.effect import Effect, Local
from hybridid.effects.over import Over, value_of

Array = NDArray[np.float64]
Values = Mapping[str, float]
PAIRS = 200
"""Pairs of places that are compared."""
SAME = 1e-6
"""Two numbers that differ by less than this share are the same."""
VARIABLES = ("time", "position", "velocity", "acceleration", "signal", "rate", "drive", "load", "level")


def law_symbols(effect: Effect) -> Local:
    """All that the law of ``effect`` may use, as symbols."""
    return Local(
        p=_symbols([p.name for p in effect.parameters]),
        z=_symbols([s.name for s in effect.states]),
        channels=_symbols(effect.channels),
        **vars(_symbols((*VARIABLES, "epsilon", "load_width"))),
    )


def is_separable(effect: Effect, constants: Values, over: Over, sizes: Values) -> bool:
    """Whether the law of ``effect`` changes with the variable of ``over``, and is a function of it times a
    function of all others.

    ``constants`` are its parameters by short name, ``epsilon`` and ``load_width``; ``sizes`` those of
    ``VARIABLES`` and channels, 1 where none is given. The places are drawn from normal distributions of these
    sizes, the same every time.
    The answer for a law with states is no: they follow the variable, too.
    """
    if effect.states or not set(over.channels) <= set(effect.channels):
        return False
    at = law_symbols(effect)
    own = {one.name() for one in ca.symvar(ca.SX(value_of(over, at)))}
    symbols = {one.name(): one for one in ca.symvar(effect.law(at))}
    drawn = [name for name in symbols if name not in constants]
    if not own.intersection(drawn):
        return False
    law = ca.Function("law", list(symbols.values()), [effect.law(at)]).map(PAIRS)
    rng = np.random.default_rng(0)
    places = [{name: sizes.get(name, 1.0) * rng.standard_normal(PAIRS) for name in drawn} for _ in range(2)]

    def efforts(variable: int, rest: int) -> Array:
        """With the variable of one place, and all others of the same or the other one."""
        at_place = {name: places[variable if name in own else rest][name] for name in drawn}
        rows = {**{name: np.full(PAIRS, value) for name, value in constants.items()}, **at_place}
        return np.asarray(law(*(rows[name][None] for name in symbols))).ravel()

    same, crossed = efforts(0, 0) * efforts(1, 1), efforts(0, 1) * efforts(1, 0)
    changes = _differ(efforts(0, 0), efforts(1, 0))
    return changes and not _differ(same, crossed)


def _differ(one: Array, other: Array) -> bool:
    return bool(np.abs(one - other).sum() > SAME * np.abs(one + other).sum())


def _symbols(names: Iterable[str]) -> SimpleNamespace:
    return SimpleNamespace(**{name: ca.SX.sym(name) for name in names})
