"""``Estimate``: what a fit found, and how far it can be trusted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybridid.settings.fit import FitSettings

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Progress:
    """One report from a running fit; ``fraction`` of the work done where it is known."""

    stage: str
    iteration: int
    cost: float
    fraction: float | None = None


@dataclass(frozen=True)
class EstimatedParameter:
    """One estimate.

    ``std`` is its standard error: noise, autocorrelated as it is, and ``smoothing``, the part
    that the smoothing of sign(v) may have moved it by (signed: estimate less unsmoothed).
    """

    name: str
    value: float
    std: float
    unit: str
    lower: float
    upper: float
    at_bound: bool
    identifiable: bool
    meaning: str = ""
    smoothing: float = 0.0


@dataclass(frozen=True)
class Solution:
    """Where an optimiser stopped: parameters (n_p,), initial states (w, n_x), half sum of squares."""

    p: Array
    x0: Array
    cost: float
    status: str
    converged: bool
    iterations: int
    history: tuple[float, ...] = ()


@dataclass(frozen=True)
class Estimate:
    """A fitted model's numbers.

    ``cost`` is half the sum of squared output errors, each over its output's standard
    deviation. ``correlation`` (n, n) is of the estimated ``parameters`` in their order;
    ``known`` holds the values that were not estimated. ``initial_states`` (w, n_x) belong
    to the horizons in ``origin``, rows of (record index, first sample, end sample).
    """

    parameters: tuple[EstimatedParameter, ...]
    known: Mapping[str, float]
    correlation: Array
    initial_states: Array
    origin: tuple[tuple[int, int, int], ...]
    cost: float
    status: str
    converged: bool
    iterations: int
    seconds: Mapping[str, float]
    substeps: int
    settings: FitSettings
    history: tuple[float, ...] = ()
    starts: tuple[float, ...] = ()
    warnings: tuple[str, ...] = field(default=())

    @property
    def values(self) -> dict[str, float]:
        """Every parameter of the model by name, estimated or known."""
        return {**self.known, **{p.name: p.value for p in self.parameters}}

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, strings and lists, for JSON."""
        return {
            "parameters": {
                p.name: {k: v for k, v in asdict(p).items() if k != "name"} for p in self.parameters
            },
            "known": dict(self.known),
            "correlation": self.correlation.tolist(),
            "initial_states": self.initial_states.tolist(),
            "origin": [list(row) for row in self.origin],
            "cost": self.cost,
            "status": self.status,
            "converged": self.converged,
            "iterations": self.iterations,
            "seconds": dict(self.seconds),
            "substeps": self.substeps,
            "settings": asdict(self.settings),
            "history": list(self.history),
            "starts": list(self.starts),
            "warnings": list(self.warnings),
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Estimate:
        """The estimate that ``to_dict`` wrote."""
        settings = dict(data["settings"], continuation=tuple(data["settings"]["continuation"]))
        return cls(
            parameters=tuple(EstimatedParameter(name=n, **v) for n, v in data["parameters"].items()),
            known=dict(data["known"]),
            correlation=np.array(data["correlation"], dtype=float),
            initial_states=np.array(data["initial_states"], dtype=float),
            origin=tuple((int(r), int(a), int(b)) for r, a, b in data["origin"]),
            cost=data["cost"],
            status=data["status"],
            converged=data["converged"],
            iterations=data["iterations"],
            seconds=dict(data["seconds"]),
            substeps=data["substeps"],
            settings=FitSettings(**settings),
            history=tuple(data["history"]),
            starts=tuple(data["starts"]),
            warnings=tuple(data["warnings"]),
        )
