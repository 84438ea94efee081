"""``Orders``: the number of past values of each signal that a NARX network uses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybridid.naming import unknown


@dataclass(frozen=True)
class Orders:
    """Past values that predict ``e(t)``: of the error, of each input, of the gray box' output.

    ``e(t) = F[e(t-1) .. e(t-error), u_j(t-1) .. u_j(t-inputs[j]), y_gray(t-1) .. y_gray(t-gray)]``,
    thesis Eqs. 3-11, 4-15 and 5-11. Order 0 leaves a signal out.

    Raises:
        ValueError: if an order is negative or all are zero.
    """

    error: int
    inputs: tuple[int, ...]
    gray: int

    def __post_init__(self) -> None:
        for name, order in (
            ("error", self.error),
            ("gray", self.gray),
            *(("inputs", n) for n in self.inputs),
        ):
            if order < 0:
                raise ValueError(f"residual.orders.{name} is {order}: at least 0")
        if self.regressors == 0:
            raise ValueError("residual.orders: every order is 0, so the network would see nothing")

    @property
    def exogenous(self) -> tuple[int, ...]:
        """Orders of the signals that do not depend on the network: inputs, then the gray box."""
        return (*self.inputs, self.gray)

    @property
    def regressors(self) -> int:
        """Number of the network's inputs."""
        return self.error + sum(self.exogenous)

    @property
    def longest(self) -> int:
        """The largest order of all signals."""
        return max(self.error, *self.exogenous)


def orders_of(error: int, inputs: int | Mapping[str, int], gray: int, input_names: Sequence[str]) -> Orders:
    """Orders from a config: one number for all inputs, or one for each by name (omitted: 0).

    Raises:
        ValueError: if an input is unknown or an order not allowed.
    """
    if isinstance(inputs, Mapping):
        for name in inputs:
            if name not in input_names:
                raise ValueError(unknown("input in residual.orders.inputs:", name, list(input_names)))
        by_input = tuple(int(inputs.get(name, 0)) for name in input_names)
    else:
        by_input = (int(inputs),) * len(input_names)
    return Orders(int(error), by_input, int(gray))
