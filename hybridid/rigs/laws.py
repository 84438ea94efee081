"""``Law``: one physical phenomenon in the truth of a virtual rig, as a compiled function.

The truth never uses the effects of the estimator. The laws are written a second time, in plain
arithmetic, with an exact sign function. A law acts at one contact of a machine and *resists* its motion:

    F = law(t, q, v, s, z, p, dz)

with time ``t`` [s], position ``q``, velocity ``v`` and direction ``s`` of the contact (+1 or -1 while it
slides, 0 while it sticks), the law's own states ``z``, its parameters ``p`` and the states' rates ``dz``,
which the law fills in. A law uses ``f_c * s`` and ``s * v`` for f_c sign(v) and |v|: it is smooth within
one direction, and its limits at ``v = 0``, ``s = +-1`` are the breakaway forces.

A ``loaded`` law finds the contact's drive and load after its own parameters, as p[-2] and p[-1]. Both act on
the contact and are positive in its direction. The drive is the force of the inputs along the contact. The
load is that of the ``carried`` laws (springs, weights) at this and other contacts.
"""

from __future__ import annotations

import difflib
import functools
import hashlib
import inspect
import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


class RigError(ValueError):
    """Raised for a virtual rig that cannot run: the message says what, where and what is allowed."""


@dataclass(frozen=True)
class Law:
    """One phenomenon: its equation, its parameters as (name, unit) and its number of states.

    ``function`` has the signature above and must be plain numba-compilable Python.
    ``dry``: at rest, the force jumps with the direction, so that the contact can stick. ``sided``: the force
    depends on the direction. Without such a law, a reversal is no event, which is faster.
    ``loaded``: it sees the contact's drive and load. ``carried``: its force is part of the loads; such a law
    has no states and is not loaded itself.
    ``positive`` names the parameters that must be above zero.
    """

    name: str
    equation: str
    function: Callable[..., float]
    parameters: tuple[tuple[str, str], ...]
    states: int = 0
    dry: bool = False
    sided: bool = True
    positive: tuple[str, ...] = ()
    source: str = ""
    loaded: bool = False
    carried: bool = False

    def __post_init__(self) -> None:
        if self.carried and (self.states or self.loaded or self.dry):
            raise RigError(f"law {self.name}: a carried law is a force of time, position and velocity alone")

    def __call__(self, **values: float) -> Planted:
        """The law with these values: ``STRIBECK(amplitude=5.0, velocity=0.01)``."""
        return Planted(self, tuple(values.items()))

    @property
    def fingerprint(self) -> str:
        """A hash of the law's code, so that a changed law gives a new record."""
        try:
            text = inspect.getsource(self.function)
        except (OSError, TypeError):
            text = f"{self.function.__module__}.{self.function.__qualname__}"
        return hashlib.sha256(f"{self.equation}\n{text}".encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Planted:
    """A law with its values: a part of the truth of a rig.

    ``values`` are (name, value) pairs; they are kept in the order of ``law.parameters``.

    Raises:
        RigError: for a value that is missing, unknown, not finite or out of its range.
    """

    law: Law
    values: tuple[tuple[str, float], ...]

    def __post_init__(self) -> None:
        given = dict(self.values)
        names = [name for name, _ in self.law.parameters]
        for name in given:
            if name not in names:
                raise RigError(f"law {self.law.name}: no parameter {name!r}{nearest(name, names)}")
        for name in names:
            self._check(name, given)
        object.__setattr__(self, "values", tuple((name, float(given[name])) for name in names))

    def _check(self, name: str, given: Mapping[str, float]) -> None:
        if name not in given:
            needed = ", ".join(f"{n} [{unit}]" for n, unit in self.law.parameters)
            raise RigError(f"law {self.law.name}: {name} is missing; it needs {needed}")
        if not math.isfinite(given[name]):
            raise RigError(f"law {self.law.name}: {name} is {given[name]}, must be finite")
        if name in self.law.positive and given[name] <= 0:
            raise RigError(f"law {self.law.name}: {name} is {given[name]:g}, must be above 0")

    def described(self) -> dict[str, Any]:
        """Name, values and fingerprint as plain data, for a digest or a file."""
        return {"law": self.law.name, "fingerprint": self.law.fingerprint, **dict(self.values)}


def nearest(name: str, allowed: list[str]) -> str:
    """``"; nearest: ..."`` for a misspelt name, or what is allowed."""
    close = difflib.get_close_matches(name, allowed, n=1)
    return f"; nearest: {close[0]}" if close else f"; allowed: {', '.join(allowed) or 'none'}"


@functools.cache
def compiled(function: Callable[..., float]) -> Any:
    """The law as a numba C function. All laws have one type, so that one kernel takes any list of them."""
    from numba import cfunc, types

    row = types.Array(types.float64, 1, "C")
    number = types.float64
    return cfunc(number(number, number, number, number, row, row, row), cache=True)(function)


def function_list(functions: list[Callable[..., float]]) -> Any:
    """The laws as a numba list, without numba's warning that first-class functions are experimental."""
    from numba.core.errors import NumbaExperimentalFeatureWarning
    from numba.typed import List

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NumbaExperimentalFeatureWarning)
        return List([compiled(function) for function in functions])
