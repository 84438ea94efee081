"""``Controller``: the law that drove a machine, discrete in time, to be closed over a simulated machine."""

from __future__ import annotations

import abc
from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import casadi as ca

from hybridid.declarations import Parameter, Signal, State

PERIOD = "dt"
"""Name of the controller's sampling time [s] among the parameters that a law sees."""


@dataclass(frozen=True)
class Reference(Signal):
    """A signal of the record that the law follows. An ``optional`` one is zero in a record without it."""

    optional: bool = False


class Controller(abc.ABC):
    """``u_k = command(r_k, y_k, x_k)``, ``x_k+1 = update(r_k, y_k, x_k)``; u is held until the next sample.

    A subclass declares its parts as class attributes and writes ``command``, and ``update`` and ``start`` if
    it has states. Their arguments hold CasADi scalars by name: ``reference.position``, ``outputs.position``,
    ``state.previous``, ``p.kp``. ``p.dt`` is the controller's sampling time in s.

    ``outputs`` are the plant's outputs that the law reads, ``commands`` the plant's inputs that it sets; both
    have the plant's names and units. The law works at each ``every``-th sample of the record, and its command
    acts ``delay`` samples later. ``memory`` is the number of its own samples that it must have seen before
    its command is right, such as 1 for a difference of two samples: until then the recorded command acts.
    """

    name: str
    meaning: str
    source: str
    references: tuple[Reference, ...]
    outputs: tuple[Signal, ...]
    commands: tuple[Signal, ...]
    parameters: tuple[Parameter, ...]
    states: tuple[State, ...] = ()
    every: int = 1
    delay: int = 0
    memory: int = 0

    @abc.abstractmethod
    def command(
        self, reference: SimpleNamespace, outputs: SimpleNamespace, state: SimpleNamespace, p: SimpleNamespace
    ) -> Mapping[str, ca.SX]:
        """Every command, by its name, in its declared unit."""

    def update(
        self, reference: SimpleNamespace, outputs: SimpleNamespace, state: SimpleNamespace, p: SimpleNamespace
    ) -> Mapping[str, ca.SX]:
        """Every state at the controller's next sample, by the state's name."""
        return {}

    def start(
        self, reference: SimpleNamespace, outputs: SimpleNamespace, p: SimpleNamespace
    ) -> Mapping[str, ca.SX]:
        """The states at the record's first sample; zero for those that are left out."""
        return {}


def clamped(value: ca.SX, limit: ca.SX | float) -> ca.SX:
    """``value`` between ``-limit`` and ``limit``: an amplifier, an integrator that must not wind up."""
    return ca.fmin(ca.fmax(value, -limit), limit)


def quantised(value: ca.SX, step: ca.SX | float) -> ca.SX:
    """``value`` in whole counts of ``step``, rounded to the nearest: an encoder, a converter."""
    return step * ca.floor(value / step + 0.5)
