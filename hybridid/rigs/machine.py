"""``Machine``: masses, inputs and contacts. ``Motion``: its motion over time.

    mass q'' = input_matrix u - directions^T F,    F_c = sum of the laws at contact c

Contact c has the position ``directions[c] . q``. A carriage on its guide is one mass and one contact. A
motor and a load on one shaft are two masses and three contacts; the third, along ``(1, -1)``, has a spring.
The last ``prescribed`` coordinates have no mass: their motion is given, as that of the road under a wheel,
and the equation of motion is that of the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybridid.rigs.laws import Planted, RigError, function_list

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Machine:
    """The truth of a rig.

    ``mass`` (n, n), constant and positive definite; ``input_matrix`` (n, n_u); ``directions``
    (c, n + prescribed); ``laws`` holds the laws at each of the c contacts. Contacts with the last
    ``prescribed`` coordinates drive the machine by a given motion: see ``Motion.drive``.

    Raises:
        RigError: if shapes disagree, the mass is not positive definite, the directions of the dry contacts
            are not independent (friction at rest would be indeterminate), or one of the dry contacts has a
            prescribed motion.
    """

    mass: tuple[tuple[float, ...], ...]
    input_matrix: tuple[tuple[float, ...], ...]
    directions: tuple[tuple[float, ...], ...]
    laws: tuple[tuple[Planted, ...], ...]
    prescribed: int = 0

    def __post_init__(self) -> None:
        mass = np.array(self.mass, dtype=float)
        n = len(mass)
        if mass.shape != (n, n) or not np.allclose(mass, mass.T) or np.linalg.eigvalsh(mass).min() <= 0:
            raise RigError(f"machine: mass must be symmetric and positive definite, is {self.mass}")
        if np.array(self.input_matrix).shape[:1] != (n,):
            raise RigError(f"machine: {n} masses need {n} rows of inputs")
        if self.prescribed < 0 or np.array(self.directions).shape[1:] != (self.coordinates,):
            raise RigError(
                f"machine: {n} masses and {self.prescribed} prescribed motions need directions of as many"
            )
        if len(self.laws) != len(self.directions):
            raise RigError(f"machine: {len(self.directions)} contacts need as many sets of laws")
        dry = np.array(self.directions)[list(self.dry)]
        if len(dry) and np.linalg.matrix_rank(dry) < len(dry):
            raise RigError("machine: contacts with dry friction must have independent directions")
        if dry[:, n:].any():
            raise RigError("machine: a contact with a prescribed motion cannot have dry friction")

    @property
    def coordinates(self) -> int:
        """Number of coordinates: those with mass, then the prescribed ones."""
        return len(self.mass) + self.prescribed

    @property
    def dry(self) -> tuple[bool, ...]:
        """Which contacts can stick, shape (c,)."""
        return tuple(any(planted.law.dry for planted in laws) for laws in self.laws)

    @property
    def sided(self) -> tuple[bool, ...]:
        """At which contacts some law depends on the direction, shape (c,)."""
        return tuple(any(planted.law.dry or planted.law.sided for planted in laws) for laws in self.laws)

    @property
    def planted(self) -> tuple[tuple[int, Planted], ...]:
        """(contact, law) of every law, in the order of the laws' states and parameters."""
        return tuple((c, law) for c, laws in enumerate(self.laws) for law in laws)


class Motion:
    """The motion of a machine from rest at ``positions``: all contacts stick, the laws' states are zero.

    ``tolerance`` is the allowed local error of a step, relative to the state; the absolute one is a
    hundredth of it in the states' SI units. ``max_step`` [s] limits the step.
    """

    def __init__(
        self,
        machine: Machine,
        positions: ArrayLike,
        velocities: ArrayLike | None = None,
        tolerance: float = 1e-9,
        max_step: float = float("inf"),
    ) -> None:
        n, laws = machine.coordinates, machine.planted
        states = sum(planted.law.states for _, planted in laws)
        self.time = 0.0
        self.events = 0
        self._n, self._tolerance, self._max_step = n, tolerance, max_step
        self._driven = slice(n - machine.prescribed, n)
        self._directions = np.array(machine.directions, dtype=float)
        self._gliding = ~np.array(machine.dry)
        self._y = np.concatenate([np.asarray(positions, float), np.zeros(n + states)])
        self._slip = np.zeros(len(machine.directions))
        self._tables = _tables(machine)
        if velocities is not None:
            self._y[n : 2 * n] = velocities
            self._slip[:] = np.sign(self._directions @ self._y[n : 2 * n])

    @property
    def positions(self) -> Array:
        """Coordinates q, shape (n,)."""
        return self._y[: self._n].copy()

    @property
    def velocities(self) -> Array:
        """Their velocities, shape (n,)."""
        return self._y[self._n : 2 * self._n].copy()

    @property
    def law_states(self) -> Array:
        """The laws' own states, in the order of ``Machine.planted``."""
        return self._y[2 * self._n :].copy()

    @property
    def slip(self) -> Array:
        """Direction of each contact: +1 or -1 while it slides, 0 while it sticks; shape (c,)."""
        return self._slip.copy()

    def drive(self, positions: ArrayLike, velocities: ArrayLike) -> None:
        """Set the prescribed coordinates to ``positions``, from where they move with ``velocities``.

        Both have shape (prescribed,) and hold until the next call. The motion is continuous if the positions
        follow from the last call.
        """
        n, driven = self._n, self._driven
        self._y[driven] = positions
        self._y[n + driven.start : n + driven.stop] = velocities
        turned = np.sign(self._directions @ self._y[n : 2 * n])
        self._slip[self._gliding] = turned[self._gliding]

    def advance(self, duration: float, inputs: Array) -> None:
        """Advance by ``duration`` [s] with constant ``inputs`` (n_u,).

        Raises:
            RigError: if the motion cannot be integrated (a law diverges or chatters).
        """
        from hybridid.rigs.integrator import advance

        events = advance(
            self.time, duration, inputs, self._y, self._slip, self._tolerance, self._max_step, *self._tables
        )
        if events < 0:
            raise RigError(f"virtual rig: the truth cannot be integrated beyond {self.time:.6g} s")
        self.events += events
        self.time += duration


def _tables(machine: Machine) -> Any:
    """The machine as flat arrays for the compiled integrator."""
    from hybridid.rigs.integrator import Tables

    contacts, planted = zip(*machine.planted, strict=True)
    parameters = [[value for _, value in one.values] for one in planted]
    # no force moves a prescribed coordinate: its rows of the inverse mass matrix are zero
    massless = (0, machine.prescribed)
    return Tables(
        inverse_mass=np.pad(np.linalg.inv(np.array(machine.mass, dtype=float)), (massless, massless)),
        input_matrix=np.pad(np.array(machine.input_matrix, dtype=float), (massless, (0, 0))),
        directions=np.array(machine.directions, dtype=float),
        dry=np.array(machine.dry),
        sided=np.array(machine.sided),
        laws=function_list([one.law.function for one in planted]),
        contact=np.array(contacts, dtype=np.int64),
        state_start=_starts([one.law.states for one in planted]),
        parameter_start=_starts([len(values) for values in parameters]),
        parameters=np.array([value for values in parameters for value in values], dtype=float),
        loaded=np.array([one.law.loaded for one in planted], dtype=bool),
        carried=np.array([one.law.carried for one in planted], dtype=bool),
    )


def _starts(lengths: Sequence[int]) -> NDArray[np.int64]:
    """First index of each part, and the end: (2, 0, 1) -> [0, 2, 2, 3]."""
    return np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
