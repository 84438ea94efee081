"""The friction figures of a run tree: efforts of the gray box and of the hybrid along a prediction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from hybridid.declarations import Port
from hybridid.hybrid import PortHybrid
from hybridid.model import Model
from hybridid.plotting.friction import FrictionCurve, FrictionData, friction_plot
from hybridid.plotting.style import Plot
from hybridid.records.record import Record
from hybridid.validation.port_efforts import port_efforts, resisting_effort
from pipelines.shared.config import Settings
from pipelines.shared.fitted import fit_of, fitted_model
from pipelines.shared.hybrids import hybrid_of
from pipelines.shared.predictions import Stored


@dataclass(frozen=True, eq=False)
class Law:
    """A model whose efforts are drawn; ``name`` is the one under which it was validated."""

    name: str
    model: Model
    values: Mapping[str, float]


def laws_of(settings: Settings, tree: Path) -> list[Law]:
    """The gray box, and the hybrid if its network is inside the equations."""
    model, estimate = fitted_model(settings, tree)
    laws = [Law(fit_of(tree).model, model, estimate.values)]
    hybrid = hybrid_of(tree, model)
    if isinstance(hybrid, PortHybrid):
        laws.append(Law(hybrid.name, hybrid.model, hybrid.values))
    return laws


def friction_plots(
    laws: Sequence[Law], record: Record, stored: Sequence[Stored]
) -> Iterator[tuple[Port, Callable[[], Plot]]]:
    """What draws a figure for each port: the efforts of every model along the last of its own predictions
    with the recorded inputs."""
    curves: dict[str, list[FrictionCurve]] = {}
    ports: dict[str, Port] = {}
    for law in laws:
        own = [s for s in stored if s.model == law.name and s.prediction.view != "loop"]
        for at in port_efforts(law.model, law.values, record, own[-1].prediction) if own else ():
            order = np.argsort(at.over) if at.static else np.arange(len(at.over))
            efforts = {name.partition(".")[2]: effort[order] for name, effort in at.efforts.items()}
            curves.setdefault(at.port.name, []).append(FrictionCurve(law.name, at.over[order], efforts))
            ports[at.port.name] = at.port
    for name, drawn in curves.items():
        found = resisting_effort(laws[0].model, laws[0].values, record, ports[name])
        data = None if found is None else FrictionData(*found)
        yield ports[name], partial(friction_plot, ports[name], drawn, record.name, record.provenance, data)
