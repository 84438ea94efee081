"""The section ``residual``, for each kind of network."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hybridid.residuals.settings import Over, Physics, RBFBounds, Training
from hybridid.settings import check, inlined, setting
from hybridid.settings.choices import InitialState


@dataclass(frozen=True)
class OrdersSection:
    """Past samples that a NARX network sees."""

    error: int = setting(7, "past errors that the network sees", least=0)
    inputs: int | Mapping[str, int] = setting(
        2, "past values of each input, or of each by name, as in {torque: 6}", least=0, shown="N"
    )
    gray: int = setting(4, "past outputs of the gray box", least=0)


@dataclass(frozen=True)
class NARXSection:
    """A network on the error of each output. Lists of ``depth``, ``width`` and ``seeds`` make a grid."""

    kind: Literal["narx"] = setting("narx", "a network after the output")
    outputs: tuple[str, ...] | None = setting(None, "names of the outputs that get a network", null="all")
    orders: OrdersSection = setting(OrdersSection(), "past samples that the network sees")
    depth: tuple[int, ...] = setting((3,), "hidden layers; several make a grid", least=1, some=True)
    width: tuple[int, ...] = setting(
        (16,), "neurons in each hidden layer; several make a grid", least=1, some=True
    )
    every: int = setting(1, "the network works on every n-th sample", least=1)
    increment: bool = setting(False, "predict the change of the error, which suits a slow error")
    initial_state: InitialState = setting(
        "estimated", "the state in which the gray box' run starts whose error is learned"
    )
    seeds: tuple[int, ...] = setting(
        (0, 1, 2),
        "of each size one network for each; sizes are chosen by the mean of their seeds",
        least=0,
        most=2**63 - 1,
        some=True,
    )
    training: Training = inlined(Training())


@dataclass(frozen=True)
class RBFSection:
    """Radial basis functions inside the equations, at an effort or flow port.

    Several ``nodes`` or ``horizons`` are chosen from on ``folds`` blocks of the fitted records, each held out
    in turn. ``judged``: on those blocks, though there may be nothing to choose from.
    """

    kind: Literal["rbf"] = setting("rbf", "a network inside the equations")
    nodes: tuple[int, ...] = setting((8,), "numbers of nodes to choose from", least=1, some=True)
    horizons: tuple[int | None, ...] | None = setting(
        None,
        "horizons of the fit to choose from; null in the list: the whole record",
        unit="samples",
        least=2,
        some=True,
        null="the gray box' own",
    )
    port: str | None = setting(None, "the effort or flow port", null="the plant's first")
    over: Over | None = setting(
        None, "what the functions depend on", null="the velocity; at a flow port the position, its level"
    )
    span: tuple[float, float] | None = setting(
        None,
        "over which the nodes start evenly spread",
        null="what the fitted records visit",
        shown="[from,to]",
    )
    physics: Physics = setting(
        "refitted", "refitted: the parameters are estimated with the network; fixed: kept, as in the thesis"
    )
    bounds: RBFBounds = setting(RBFBounds(), "where a fit may move the nodes")
    max_iterations: int = setting(30, "iterations at most", least=1)
    folds: int = setting(4, "contiguous blocks of each record, each held out in turn", least=2)
    judged: bool = setting(False, "judge on those blocks though there is nothing to choose from")
    processes: int | None = setting(None, "fits side by side", least=1, null="one a core")

    def __post_init__(self) -> None:
        check(self, "residual")
        if self.span is not None and not self.span[0] < self.span[1]:
            raise ValueError(f"residual.span is {list(self.span)}: two rising numbers")


KINDS: Mapping[str, type] = {"narx": NARXSection, "rbf": RBFSection}
"""The section by its key ``kind``."""
