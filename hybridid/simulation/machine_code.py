"""A model's step as machine code, where the machine has a C compiler.

CasADi interprets a model seven to forty times slower than compiled code simulates it. So what will cost
more to interpret than to compile is compiled: ``c_parts`` writes C of one step, of the outputs and of
their sensitivities, for several horizons side by side (``lanes.h``). ``shoot.c``, compiled once for all
models, drives it over all horizons. The interpreter gives the same numbers to rounding.

Without a compiler everything is interpreted.
"""

from __future__ import annotations

import ctypes
import functools
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.simulation.c_code import Unwritten
from hybridid.simulation.c_parts import c_of_parts
from hybridid.simulation.compiler import c_compiler, compiled, widest
from hybridid.simulation.sensitivities import Part, output_part, step_part
from hybridid.simulation.windows import Windows

Array = NDArray[np.float64]
WORTH = 2e5
"""Operations of one simulation (interpreted, some 4 ns each) from which compiling, at 0.2 s, pays: the trial
of an effect simulates some two hundred times, a fit some thirty, and the code is kept."""
LANES = 4
"""Horizons side by side, where there are as many; of more, as many as a register of the processor holds."""
TURNS = 2
"""Groups of horizons that take turns, as in lanes.h."""
NO_MEMORY, STOPPED = 1, 2
"""What ``shoot`` of shoot.c returns where it does not end."""
ONLY = "_only"
"""Behind the names of the functions without sensitivities."""


@dataclass(frozen=True, eq=False)
class Code:
    """Steps of ``integrator``, differentiated by initial states and ``free``, for simulations of ``steps``
    such steps, with ``lanes`` horizons side by side: 1, 4 or 8. The length of a step is left open: models of
    one structure share their code. So do derivatives by all parameters and by none (``free`` empty)."""

    model: Model
    free: tuple[str, ...]
    integrator: str
    held: bool
    steps: int
    lanes: int

    @cached_property
    def worth_it(self) -> bool:
        """Whether to simulate by machine code."""
        if c_compiler() is None or self.steps * self.parts[0].operations < WORTH:
            return False
        return self._library is not None and _driver(self.lanes) is not None

    def __call__(
        self,
        windows: Windows,
        carried: Sequence[int],
        x0: Array,
        p: Array,
        sensitivities: bool,
    ) -> tuple[Array, ...]:
        """States (w, H, n_x), outputs (w, H, n_y), final states (w, n_x) and, if asked for (else empty),
        the outputs' sensitivities (w, H, n_x + n_free, n_y) and those of the state after each horizon's last
        sample (w, n_x + n_free, n_x). The states ``carried`` run on from horizon to horizon."""
        w, length, n_x, n_y = windows.count, windows.length, len(self.model.states), len(self.model.outputs)
        n_s = self._columns(sensitivities)
        final, states, outputs = (np.empty((w, *n)) for n in ((n_x,), (length, n_x), (length, n_y)))
        slopes, ends = np.empty((w, length, n_s, n_y)), np.empty((w, 1 + n_s, n_x))
        found = {"final": final, "states": states, "outputs": outputs, "ends": ends}
        self._shoot(windows, carried, x0, p, sensitivities, {**found, **({"slopes": slopes} if n_s else {})})
        return states, outputs, final, slopes, ends[:, 1:]

    def compared(
        self,
        windows: Windows,
        carried: Sequence[int],
        x0: Array,
        p: Array,
        sensitivities: bool,
        weights: Array,
        limit: float = np.inf,
    ) -> tuple[Array, ...]:
        """r'r (w,) and, if asked for (else empty), J'J (w, n_x + n_free, n_x + n_free), J'r (w, n_x + n_free)
        and the sensitivities (w, n_x + n_free, n_x) of the state after each horizon's last sample.

        r are the recorded outputs less the simulated, J the simulated outputs' sensitivities, both times
        ``weights`` (w, H, n_y); what has the weight 0 does not count. r'r is not a number where a horizon
        leaves the numbers while samples count. It may stop once the sum of r'r is above ``limit``: it is
        infinite then, and the others say nothing."""
        w, n_x, n_s = windows.count, len(self.model.states), self._columns(sensitivities)
        spent, ends = np.empty(w), np.empty((w, 1 + n_s, n_x))
        square, error = np.empty((w, n_s, n_s)), np.empty((w, n_s))
        found = {"spent": spent, "ends": ends, **({"square": square, "error": error} if n_s else {})}
        if not self._shoot(windows, carried, x0, p, sensitivities, found, weights, limit):
            spent[:] = np.inf
        return spent, square, error, ends[:, 1:]

    def _columns(self, sensitivities: bool) -> int:
        return len(self.model.states) + len(self.free) if sensitivities else 0

    def _shoot(
        self,
        windows: Windows,
        carried: Sequence[int],
        x0: Array,
        p: Array,
        sensitivities: bool,
        found: Mapping[str, Array],
        weights: Array | None = None,
        limit: float = np.inf,
    ) -> bool:
        """Fill the arrays that ``found`` names as ``Result`` of shoot.c has them; False if it stopped at the
        ``limit``."""
        model, shoot = self._library, _driver(self.lanes)
        assert model is not None
        assert shoot is not None
        n_u, n_y = len(self.model.inputs), len(self.model.outputs)
        follows = windows.follows if carried else (-1,) * windows.count
        marks = [k in carried for k in range(len(self.model.states))]
        blocks = _blocks(follows, self.lanes)
        integers = [np.array(a, dtype=np.int64) for a in (blocks, follows, windows.lengths, marks)]
        compared = () if weights is None else (windows.outputs, weights)
        numbers = [
            np.ascontiguousarray(a, dtype=float)
            for a in (windows.time, windows.stages, windows.inputs, p, x0, *compared)
        ]
        sizes = (len(blocks), windows.length, windows.substeps, len(self.model.states))
        hop = 0 if self.held else 2 * n_u
        widths = (self._columns(sensitivities), n_u, windows.stages.shape[2], hop, n_y)
        h = windows.dt / windows.substeps
        task = _Task(*sizes, *widths, *map(_address, integers), h, limit, *map(_address, numbers))
        parts = (ctypes.c_void_p * 4).in_dll(model, "parts")
        advance, observe = map(ctypes.c_void_p, parts[:2] if sensitivities else parts[2:])
        result = _Found(**{name: _address(array) for name, array in found.items()})
        ended = shoot(advance, observe, ctypes.byref(task), ctypes.byref(result))
        if ended == NO_MEMORY:
            raise MemoryError("no memory left to simulate in")
        return ended != STOPPED

    @property
    def _by(self) -> tuple[str, ...]:
        """The parameters of the columns that are compiled; of these, the first are used."""
        return self.free or tuple(p.name for p in self.model.free)

    @property
    def parts(self) -> tuple[Part, ...]:
        """Step and outputs, with sensitivities and without."""
        key = ("parts", self._by, self.integrator, self.held, self.lanes == 1)
        return self.model.kept(key, self._differentiated)

    def _differentiated(self) -> tuple[Part, ...]:
        step, outputs = "model_advance", "model_observe"
        return (
            step_part(step, self.model, self.integrator, self.held, self._by, self.lanes == 1),
            output_part(outputs, self.model, self._by),
            step_part(step + ONLY, self.model, self.integrator, self.held, None),
            output_part(outputs + ONLY, self.model, None),
        )

    @property
    def _library(self) -> ctypes.CDLL | None:
        key = ("library", self._by, self.integrator, self.held, self.lanes)
        return self.model.kept(key, self._make_library)

    def _make_library(self) -> ctypes.CDLL | None:
        """The library, or None if the compiler fails or an operation has no C. It is known by what CasADi
        tells of the functions: that costs a sixth of writing their C."""
        said = "".join(part.said for part in self.parts)
        try:
            return compiled(
                _text("c_code.py") + _text("c_parts.py") + _side_by_side(self.lanes) + said, self._written
            )
        except Unwritten as why:
            warnings.warn(f"{why}: the model is interpreted, which is slower", stacklevel=2)
            return None

    def _written(self) -> str:
        return _side_by_side(self.lanes) + c_of_parts(self.parts, widest() if self.lanes == 1 else 1)


def _typed(kind: type, *names: str) -> tuple[tuple[str, type], ...]:
    return tuple((name, kind) for name in names)


class _Task(ctypes.Structure):
    """``Task`` of shoot.c."""

    _fields_ = (
        *_typed(ctypes.c_longlong, "blocks", "length", "steps", "n_x", "n_s", "n_u", "n_stage", "hop", "n_y"),
        *_typed(ctypes.c_void_p, "members", "follows", "lengths", "carried"),
        *_typed(ctypes.c_double, "h", "limit"),
        *_typed(ctypes.c_void_p, "time", "stages", "inputs", "p", "x0", "measured", "weights"),
    )


class _Found(ctypes.Structure):
    """``Result`` of shoot.c."""

    _fields_ = _typed(
        ctypes.c_void_p, "final", "states", "outputs", "slopes", "ends", "spent", "square", "error"
    )


def _address(array: NDArray[Any]) -> int:
    return array.ctypes.data


@functools.cache
def _driver(lanes: int) -> Callable[..., int] | None:
    """``shoot`` of shoot.c, or None if the compiler fails."""
    source = _side_by_side(lanes) + _text("shoot.c")
    driver = compiled(source, lambda: source)
    return None if driver is None else driver.shoot


def _side_by_side(lanes: int) -> str:
    sizes = {"LANES": lanes, "TURNS": TURNS, "COLUMNS": widest()}
    return "".join(f"#define {name} {size}\n" for name, size in sizes.items()) + _text("lanes.h")


@functools.cache
def _text(name: str) -> str:
    return (resources.files("hybridid.simulation") / name).read_text(encoding="utf-8")


def lanes_for(horizons: int) -> int:
    """How many of so many ``horizons`` to simulate side by side."""
    if horizons <= LANES // 2:
        return 1
    return LANES if horizons <= LANES else widest()


@functools.lru_cache
def _blocks(follows: tuple[int, ...], lanes: int) -> NDArray[np.int64]:
    """Horizons simulated together, (blocks, ``TURNS lanes``), -1 where a lane is left over: those that follow
    none first, then those that follow these, and so on."""
    depth: list[int] = []
    for before in follows:
        depth.append(0 if before < 0 else depth[before] + 1)
    size, blocks = TURNS * lanes, []
    for level in range(max(depth, default=-1) + 1):
        members = [k for k, own in enumerate(depth) if own == level]
        members += [-1] * (-len(members) % size)
        blocks += [members[k : k + size] for k in range(0, len(members), size)]
    return np.array(blocks, dtype=np.int64)
