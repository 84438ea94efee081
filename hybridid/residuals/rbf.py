"""A radial basis function network as one more effect at an effort or flow port (thesis Eqs. 6-4 to 6-6).

    F(v) = sum_i w_i exp(-(v - c_i)² / (2 s_i²))

It takes the place of a physical law (of friction, of an outlet), so the same estimator fits its centres c,
widths s and weights w in simulation. With all weights at zero, it gives zero.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import Port
from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect, EffectParameter, Law, Local
from hybridid.residuals.settings import Over, RBFBounds

Array = NDArray[np.float64]
DIMENSIONS: dict[Over, Dimension] = {
    "velocity": Dimension(position=1, time=-1),
    "position": Dimension(position=1),
}
EFFECT = "rbf"


@dataclass(frozen=True)
class RBFNetwork:
    """``nodes`` Gaussians over a port's velocity or position, spread over ``span`` (in its unit).

    Raises:
        ValueError: if there are no nodes or the span is empty.
    """

    nodes: int
    span: tuple[float, float]
    over: Over = "velocity"
    bounds: RBFBounds = field(default_factory=RBFBounds)

    def __post_init__(self) -> None:
        if self.nodes < 1:
            raise ValueError(f"residual.nodes is {self.nodes}: at least 1")
        if self.over not in DIMENSIONS:
            raise ValueError(f"residual.over is {self.over!r}, allowed: {', '.join(DIMENSIONS)}")
        if not self.span[0] < self.span[1]:
            raise ValueError(f"residual.span is {list(self.span)}: two rising numbers")

    @property
    def centres(self) -> Array:
        """Initial centres of the nodes, (nodes,), in the port's unit."""
        low, high = self.span
        return np.linspace(low, high, self.nodes) if self.nodes > 1 else np.array([(low + high) / 2])

    @property
    def spacing(self) -> float:
        """Distance between neighbouring nodes, in the port's unit."""
        return (self.span[1] - self.span[0]) / max(self.nodes - 1, 2)

    def effect(self, port: Port) -> Effect:
        """The network as an effect for ``port``."""
        parameters: list[EffectParameter] = []
        for k, centre in enumerate(self.centres, 1):
            parameters += self._node(k, float(centre), port)
        letter = {"velocity": "v", "position": "x"}[self.over]
        of_a_level = {"velocity": "net flow", "position": "level"}
        argument = of_a_level[self.over] if port.kind == "flow" else self.over
        return Effect(
            id=EFFECT,
            kind=port.kind,
            title=f"radial basis functions of the {argument}, {self.nodes} nodes",
            equation=f"F = Σ w_i exp(-({letter} - c_i)²/(2 s_i²)), i = 1 … {self.nodes}",
            law=LAWS[self.over],
            parameters=tuple(parameters),
            source="thesis Eqs. 6-4 to 6-6",
            pattern="none: it can take the shape of any law: it says how much is missing, not what",
        )

    def _node(self, k: int, centre: float, port: Port) -> list[EffectParameter]:
        """Centre and width in the port's units, the weight in multiples of its effort scale."""
        argument, effort = DIMENSIONS[self.over], Dimension(effort=1)
        low, high = self._centre_bounds(centre)
        near, far = self._width_bounds()
        down, up = self._weight_bounds(port)
        width = min(max(self.spacing, near), far)
        return [
            EffectParameter(f"c_{k}", argument, f"centre of node {k}", centre, low, high, absolute=True),
            EffectParameter(f"s_{k}", argument, f"width of node {k}", width, near, far, absolute=True),
            EffectParameter(f"w_{k}", effort, f"weight of node {k}", 0.0, down, up, nests=True),
        ]

    def _centre_bounds(self, centre: float) -> tuple[float, float]:
        room = self.bounds.centre_room * self.spacing
        low, high = self.bounds.centre or (centre - room, centre + room)
        return min(low, centre), max(high, centre)

    def _width_bounds(self) -> tuple[float, float]:
        low, high = self.bounds.width_room
        return self.bounds.width or (low * self.spacing, high * self.spacing)

    def _weight_bounds(self, port: Port) -> tuple[float, float]:
        room = self.bounds.weight_room
        low, high = self.bounds.weight or (-room * port.effort_scale, room * port.effort_scale)
        return low / port.effort_scale, high / port.effort_scale


def _gaussian_sum(x: ca.SX | float, p: SimpleNamespace) -> ca.SX:
    """``sum_i w_i exp(-(x - c_i)² / (2 s_i²))`` over the nodes that ``p`` holds."""
    total = ca.SX(0)
    for k in range(1, len(vars(p)) // 3 + 1):
        c, s, w = (getattr(p, f"{letter}_{k}") for letter in "csw")
        total = total + w * ca.exp(-((x - c) ** 2) / (2 * s**2))
    return total


# plain functions of a module, so that models with a network can be sent to other processes
def of_velocity(at: Local) -> ca.SX:
    """The network's effort over the port's velocity."""
    return _gaussian_sum(at.velocity, at.p)


def of_position(at: Local) -> ca.SX:
    """The network's effort over the port's position."""
    return _gaussian_sum(at.position, at.p)


LAWS: dict[Over, Law] = {"velocity": of_velocity, "position": of_position}
