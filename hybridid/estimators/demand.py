"""What a fit needs, from the sizes of its model, of its records and of its settings alone."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.demand import Demand
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.fit import FitSettings

_BASE = 2e7
"""Bytes of the libraries that a fit loads."""
_STAGES = 4
"""Evaluations of the equations in each step of the integrator."""
_SECONDS = 5e-10
"""Of each operation, compiled."""
_CALL = 1e-3
"""Seconds of an evaluation, however small."""
_BUILD = 5e-6
"""Seconds to differentiate and compile each operation."""
_NODE = 50
"""Bytes of each operation in CasADi's graph."""
_LEAST = 5
"""Evaluations in each stage of the continuation at least."""
_RADIAL = 10
"""Operations of one radial basis function."""


def fit_demand(model: Model, records: Sequence[Record], settings: FitSettings, nodes: int = 0) -> Demand:
    """Of a fit of ``model``, to which ``nodes`` radial basis functions are added."""
    samples = sum(record.n for record in records)
    n_x, n_y, n_u = (len(part) for part in (model.states, model.outputs, model.inputs))
    operations = int(model.f.n_instructions()) + _RADIAL * nodes
    directions = n_x + len(model.free) + 3 * nodes
    substeps = settings.substeps or 1
    horizons = 1 if settings.horizon is None else max(1, samples // settings.horizon)
    graph = _STAGES * operations * (1 + directions)
    held = all(channel.hold == "zoh" for record in records for channel in record.input_channels)
    stages = 0 if held else n_u * 2 * substeps
    solver = 0.0
    if settings.method == "multiple_shooting":  # each step has its own operations in the graph
        graph *= substeps
        solver = 4000.0 * samples
    memory = (
        _BASE
        + 8 * samples * (6 * n_y * directions + 40 + 2 * stages)
        + 24 * horizons * directions**2
        + _NODE * graph
        + 8 * settings.starts * (len(model.parameters) + 15)
        + solver
    )
    steps = samples * substeps * _STAGES * operations * (1 + directions)
    evaluations = _LEAST * len(settings.continuation) * settings.starts
    return Demand(
        "the fit", memory, graph * _BUILD + evaluations * (steps * _SECONDS + _CALL), _keys(settings, nodes)
    )


def _keys(settings: FitSettings, nodes: int) -> tuple[str, ...]:
    """The settings that are far from their defaults, the furthest first; none: the records are long."""
    usual = {
        f"residual.nodes ({nodes})": nodes / 20,
        f"estimator.substeps ({settings.substeps})": (settings.substeps or 1) / 50,
        f"estimator.starts ({settings.starts})": settings.starts / 10,
    }
    far = sorted((name for name, times in usual.items() if times > 1), key=lambda name: -usual[name])
    return tuple(far[:1]) or ("the length of the records (preprocess.steps can decimate them)",)
