"""Settings of a NARX network and of its training; bounds on the nodes of an RBF network."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hybridid.residuals.orders import Orders
from hybridid.settings import check, setting

Over = Literal["velocity", "position"]
"""What the argument of a radial basis function is. At a flow port the position is the level."""
Physics = Literal["refitted", "fixed"]
"""Whether the parameters are estimated together with the network, or kept."""

SMALL = 64
"""Width up to which networks train faster together than one after the other. A training step of a narrow
network takes mostly the overhead of its function calls; that of a wider one takes mostly arithmetic."""

PAIRS = 20
"""Steps that lbfgs remembers."""


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
    """How networks are trained: on the mean squared error over ``horizons`` in turn.

    A horizon of 1 is the one-step prediction of the thesis. Over a horizon of h grid samples, the network
    starts from measured errors and then uses its own predictions as past errors; the gradient goes back
    through all h samples. ``(1, 10, 50)`` goes from easy to hard. On each horizon, training ends when the
    held-out error has not decreased for ``patience`` epochs, or after ``epochs``. The weights with the
    lowest held-out error of all are kept.

    The ``optimiser`` "adam" takes small random steps, ``batch`` predicted samples each, at ``learning_rate``.
    It suits long records and wide networks. "lbfgs" takes quasi-Newton steps on all samples at once, an epoch
    each, to the optimum of its objective. It suits networks of some hundred weights on records of some
    thousand samples. Its last horizon may be None: the whole record from an error of zero, as in use. For
    each seed it trains ``starts`` random networks, each to its optimum, and the network is their mean. Only
    where the held-out error ends the training, the weights of the lowest held-out error are kept.

    With the ``criterion`` "free_run", the held-out error is that on the held-out blocks in a simulation of
    the whole record from an error of zero, as in use. With "horizon", it is the error over windows of the
    last horizon, each from measured errors, as in the thesis.

    Each record is cut into ``blocks`` contiguous blocks; ``held_out`` is the share of them that is not used
    for training. Half of ``weight_decay`` times the sum of the squared weights is added to the mean squared
    error.
    A network has diverged if its |error| exceeds ``guard`` times the largest error in the training data.
    ``precision`` is that of the arithmetic. A network trained in a stack equals one trained alone, up to
    rounding.

    Raises:
        ValueError: if a setting is outside what is allowed.
    """

    horizons: tuple[int | None, ...] = setting(
        (1, 10, 50),
        "how long the network runs free in training, one length after the other; [1]: one step ahead, "
        "as in the thesis; null as the last, with optimiser=lbfgs: the whole record from an error of zero",
        unit="samples",
        least=1,
        some=True,
    )
    optimiser: Literal["adam", "lbfgs"] = setting(
        "adam",
        "adam: random steps, for long records and wide networks; lbfgs: quasi-Newton steps on all samples, "
        "for small networks on short records",
    )
    starts: int = setting(
        1,
        "random networks trained for each seed, whose mean is the network; with optimiser=lbfgs",
        least=1,
    )
    criterion: Literal["free_run", "horizon"] = setting(
        "free_run",
        "held-out error that ends the training; horizon: of windows that start from measured errors",
    )
    epochs: int = setting(200, "epochs on each horizon at most", least=1)
    patience: int = setting(20, "epochs without a lower held-out error that end the training", least=1)
    batch: int = setting(512, "predicted samples in each step of adam", least=1)
    learning_rate: float = setting(1e-3, "learning rate of adam", above=0)
    weight_decay: float = setting(0.0, "half of it times the squared weights is added to the error", least=0)
    held_out: float = setting(0.2, "share of the blocks that no gradient sees", above=0, most=0.5)
    blocks: int = setting(10, "contiguous blocks of each record", least=2)
    guard: float = setting(
        10.0,
        "a network whose |error| exceeds the largest that trained it so many times has diverged",
        above=1,
    )
    precision: Literal["single", "double"] = setting(
        "single", "precision of adam's arithmetic; lbfgs is double"
    )

    def __post_init__(self) -> None:
        check(self, "residual")
        *early, last = self.horizons
        given = [*early, *([] if last is None else [last])]
        rising = [one for one in given if one is not None]
        if len(rising) < len(given) or sorted(rising) != rising:
            raise ValueError(
                f"residual.horizons is {list(self.horizons)}: rising numbers of samples, such as "
                "[1, 10, 50]; null may be the last"
            )
        if self.optimiser == "adam" and last is None:
            raise ValueError("residual.horizons ends with null, the whole record: only optimiser=lbfgs can")
        if self.optimiser == "adam" and self.starts > 1:
            raise ValueError(f"residual.starts is {self.starts}: only optimiser=lbfgs can begin several")
        if self.criterion == "horizon" and last is None:
            raise ValueError("residual.criterion=horizon needs a last horizon in samples, not null")

    @property
    def windows(self) -> tuple[int, ...]:
        """The horizons in samples: all but a whole record."""
        return tuple(one for one in self.horizons if one is not None)


@dataclass(frozen=True)
class Epoch:
    """Mean squared errors over the error's mean square: of the training over its horizon, and of the
    held-out blocks by the criterion. A ``horizon`` of None is the whole record."""

    horizon: int | None
    train: float
    held_out: float


@dataclass(frozen=True)
class RBFBounds:
    """Bounds on the nodes in a fit.

    The initial nodes are evenly spaced and one spacing wide. By default, each centre stays in its own cell
    (``centre_room`` spacings to either side), each width within ``width_room`` spacings, and each
    weight within ``weight_room`` times the port's effort scale. Then no two nodes exchange places or
    cancel each other by large weights, and a node with few samples in its range stays small.
    ``centre``, ``width`` and ``weight`` give bounds in the port's units instead, as in the thesis
    (Table 6.1: [-1, 1] m/s, [0.01, 1] m/s, [-100, 100] N).

    Raises:
        ValueError: if bounds are crossed or a width may become zero.
    """

    centre_room: float = setting(0.5, "room of a centre to either side, in spacings of the nodes", least=0)
    width_room: tuple[float, float] = setting(
        (0.5, 1.5), "from which to which width, in spacings of the nodes", above=0
    )
    weight_room: float = setting(
        0.3333, "room of a weight to either side, in multiples of the port's effort scale", above=0
    )
    centre: tuple[float, float] | None = setting(
        None, "bounds of a centre in the port's unit", null="by centre_room", shown="[from,to]"
    )
    width: tuple[float, float] | None = setting(
        None, "bounds of a width in the port's unit", above=0, null="by width_room", shown="[from,to]"
    )
    weight: tuple[float, float] | None = setting(
        None, "bounds of a weight in the port's unit", null="by weight_room", shown="[from,to]"
    )

    def __post_init__(self) -> None:
        check(self, "residual.bounds")
        for name in ("width_room", "centre", "width", "weight"):
            pair = getattr(self, name)
            if pair is not None and not pair[0] < pair[1]:
                raise ValueError(f"residual.bounds.{name} is {list(pair)}: the lower bound comes first")
