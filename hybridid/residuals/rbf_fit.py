"""The RBF network fitted in simulation, with the physical parameters fixed or fitted jointly."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import get_args

import casadi as ca

from hybridid.estimators.estimate import Estimate, Progress
from hybridid.estimators.fit import fit
from hybridid.model import Model
from hybridid.naming import unknown
from hybridid.records.record import Record
from hybridid.residuals.rbf import RBFNetwork
from hybridid.residuals.settings import Over, Physics, RBFBounds
from hybridid.settings.fit import FitSettings
from hybridid.validation.predict import free_run

PHYSICS: tuple[Physics, ...] = get_args(Physics)
MARGIN = 0.05
"""Share of the visited range by which the nodes' span exceeds it on each side."""


@dataclass(frozen=True)
class RBFPlan:
    """An RBF network at a port and how it is fitted.

    ``physics`` "fixed" keeps the gray box' estimates, as in the thesis. "refitted" estimates the physical
    parameters and the network jointly, so that the network need not compensate for the bias of estimates
    from an incomplete model. ``port`` None is the first effort or flow port. ``over`` None is the velocity of
    an effort port, and the position of a flow port, its level. ``span`` None is the range in the fitted
    records.

    Raises:
        ValueError: if a setting has a value that is not allowed.
    """

    nodes: int = 8
    port: str | None = None
    over: Over | None = None
    span: tuple[float, float] | None = None
    physics: Physics = "refitted"
    bounds: RBFBounds = field(default_factory=RBFBounds)

    def __post_init__(self) -> None:
        if self.physics not in PHYSICS:
            raise ValueError(f"residual.physics is {self.physics!r}, allowed: {', '.join(PHYSICS)}")
        RBFNetwork(self.nodes, self.span or (-1.0, 1.0), self.over or "velocity", self.bounds)


@dataclass(frozen=True, eq=False)
class RBFFit:
    """A fitted network: the ``model`` that contains it, its ``term``, and the ``estimate`` of the fit."""

    model: Model
    term: str
    network: RBFNetwork
    plan: RBFPlan
    estimate: Estimate


def fit_rbf(
    gray: Model,
    values: Mapping[str, float],
    records: Sequence[Record],
    plan: RBFPlan,
    settings: FitSettings,
    progress: Callable[[Progress], None] | None = None,
) -> RBFFit:
    """Fit the network of ``plan`` beside the gray box at ``values``.

    The fit starts from the gray box, where every weight is zero, so its cost can only decrease.

    Raises:
        ValueError: if the port is none of the plant's effort or flow ports, or the fit cannot be done.
    """
    port = port_of(gray, plan)
    where = gray.plant.port(port)
    over: Over = plan.over or ("position" if where.kind == "flow" else "velocity")
    span = plan.span or visited(gray, values, records, port, over, settings)
    network = RBFNetwork(plan.nodes, span, over, plan.bounds)
    model = (_held(gray, values) if plan.physics == "fixed" else gray).plus(network.effect(where), port)
    start = {name: value for name, value in values.items() if not name.endswith(".epsilon")}
    estimate = fit(model, records, replace(settings, continuation=(1.0,)), progress, start)
    return RBFFit(model, model.terms[-1].name, network, plan, estimate)


def visited(
    gray: Model,
    values: Mapping[str, float],
    records: Sequence[Record],
    port: str,
    over: Over,
    settings: FitSettings,
) -> tuple[float, float]:
    """The range of a port's velocity or position over the gray box' free runs of ``records``."""
    column = {"position": 0, "velocity": 1}[over]
    row = [p.name for p in gray.equation_ports].index(port)
    p = gray.values(values)
    lows, highs = [], []
    for record in records:
        run = free_run(gray, values, record, settings.initial_state, settings.integrator)
        n = len(run.time)
        motions = gray.motions.map(n)(
            run.time[None, :], run.states.T, run.of(record.inputs).T, ca.repmat(ca.DM(p), 1, n)
        )
        seen = motions.full()[row, column::2]
        lows.append(float(seen.min()))
        highs.append(float(seen.max()))
    low, high = min(lows), max(highs)
    return low - MARGIN * (high - low), high + MARGIN * (high - low)


def port_of(gray: Model, plan: RBFPlan) -> str:
    """The port of ``plan`` on the plant.

    Raises:
        ValueError: if it is none of the effort or flow ports.
    """
    names = [port.name for port in gray.equation_ports]
    if not names:
        raise ValueError(f"plant {gray.plant.name} has no effort or flow port for a network")
    if plan.port is not None and plan.port not in names:
        raise ValueError(unknown("port in residual.port:", plan.port, names))
    return plan.port or names[0]


def _held(model: Model, values: Mapping[str, float]) -> Model:
    """The model with every estimated parameter fixed."""
    known = {p.name: {"fixed": float(values[p.name])} for p in model.free}
    return replace(model, adjustments={**model.adjustments, **known})
