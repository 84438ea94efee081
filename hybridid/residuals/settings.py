"""Settings of a NARX network and of its training."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hybridid.residuals.orders import Orders

SMALL = 64
"""Width up to which networks train faster together than one after the other. A training step of a narrow
network takes mostly the overhead of its function calls; that of a wider one takes mostly arithmetic."""


@dataclass(frozen=True)
class Architecture:
    """A network ``F`` of ``depth`` hidden layers of ``width`` neurons (ELU) and a linear output.

    It works on every ``every``-th sample. With ``increment`` it gives the change of the error
    since the last sample instead of the error itself, which suits an error that varies slowly.

    Raises:
        ValueError: if a number is too small, or an increment lacks a past error.
    """

    orders: Orders
    depth: int = 3
    width: int = 16
    every: int = 1
    increment: bool = False

    def __post_init__(self) -> None:
        for name in ("depth", "width", "every"):
            if getattr(self, name) < 1:
                raise ValueError(f"residual.{name} is {getattr(self, name)}: at least 1")
        if self.increment and self.orders.error == 0:
            raise ValueError("residual.increment needs residual.orders.error of at least 1")


@dataclass(frozen=True)
class Training:
    """How networks are trained: Adam on the mean squared error over ``horizons`` in turn.

    A horizon of 1 is the one-step prediction of the thesis. Over a horizon of h grid samples, the network
    starts from measured errors and then uses its own predictions as past errors; the gradient goes back
    through all h samples. ``(1, 10, 50)`` goes from easy to hard. On each horizon, training ends when the
    held-out error has not decreased for ``patience`` epochs, or after ``epochs``. The weights with the
    lowest held-out error of all are kept. With the ``criterion`` "free_run", this is the error on the
    held-out blocks in a simulation of the whole record from an error of zero, as in use. With "horizon", it
    is the error over windows of the last horizon, each from measured errors, as in the thesis.

    Each record is cut into ``blocks`` contiguous blocks; ``held_out`` is the share of them that is not used
    for training. ``batch`` is the number of predicted samples in a step. ``weight_decay`` is Adam's L2 term.
    A network has diverged if its |error| exceeds ``guard`` times the largest error in the training data.
    ``precision`` is that of the arithmetic. A network trained in a stack equals one trained alone, up to
    rounding.

    Raises:
        ValueError: if a setting is outside what is allowed.
    """

    horizons: tuple[int, ...] = (1, 10, 50)
    epochs: int = 200
    patience: int = 20
    batch: int = 512
    learning_rate: float = 1e-3
    weight_decay: float = 0.0
    held_out: float = 0.2
    blocks: int = 10
    guard: float = 10.0
    precision: Literal["single", "double"] = "single"
    criterion: Literal["free_run", "horizon"] = "free_run"

    def __post_init__(self) -> None:
        for name, least in (("epochs", 1), ("patience", 1), ("batch", 1), ("blocks", 2)):
            if getattr(self, name) < least:
                raise ValueError(f"residual.{name} is {getattr(self, name)}: at least {least}")
        if not self.horizons or min(self.horizons) < 1 or sorted(self.horizons) != list(self.horizons):
            raise ValueError(
                f"residual.horizons is {list(self.horizons)}: rising numbers of samples, such as [1, 10, 50]"
            )
        if not 0 < self.held_out <= 0.5:
            raise ValueError(f"residual.held_out is {self.held_out}: a share above 0 and up to 0.5")
        for name, allowed in (("precision", ("single", "double")), ("criterion", ("free_run", "horizon"))):
            if getattr(self, name) not in allowed:
                raise ValueError(f"residual.{name} is {getattr(self, name)!r}, allowed: {', '.join(allowed)}")
        if not self.learning_rate > 0:
            raise ValueError(f"residual.learning_rate is {self.learning_rate}: must be positive")
        if not self.weight_decay >= 0:
            raise ValueError(f"residual.weight_decay is {self.weight_decay}: must not be negative")
        if not self.guard > 1:
            raise ValueError(f"residual.guard is {self.guard}: must be above 1")


@dataclass(frozen=True)
class Epoch:
    """Mean squared errors over the error's mean square: of the training over its horizon, and of the
    held-out blocks by the criterion."""

    horizon: int
    train: float
    held_out: float
