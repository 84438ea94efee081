"""A gray box with an RBF network inside its equations, at an effort port (thesis Eq. 6-4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from hybridid.hybrid.hybrid import Hybrid
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.residuals.explained import Explained, effort_explained
from hybridid.residuals.rbf import RBFNetwork
from hybridid.validation.predict import Prediction, free_run, horizon_run


@dataclass(frozen=True, eq=False)
class PortHybrid(Hybrid):
    """The ``gray`` box with ``network`` at ``port``, at ``values`` of the parameters of both.

    ``records`` are those fitted, ``learned_from`` their provenance.
    """

    gray: Model
    values: Mapping[str, float]
    network: RBFNetwork
    port: str
    records: tuple[str, ...]
    learned_from: str

    @cached_property
    def model(self) -> Model:
        """The gray box with the network as one more effect."""
        return self.gray.plus(self.network.effect(self.gray.plant.port(self.port)), self.port)

    @property
    def name(self) -> str:
        return f"hybrid, RBF with {self.network.nodes} nodes"

    @property
    def provenance(self) -> str:
        return self.learned_from

    def free_run(
        self, record: Record, initial_state: str = "estimated", integrator: str = "rk4"
    ) -> Prediction:
        return free_run(self.model, self.values, record, initial_state, integrator)

    def horizon_run(self, record: Record, horizon: int, integrator: str = "rk4") -> Prediction:
        return horizon_run(self.model, self.values, record, horizon, integrator)

    def explained(self, record: Record, integrator: str = "rk4") -> Explained:
        prediction = self.free_run(record, integrator=integrator)
        model = self.model
        physics = [p.name for p in self.gray.free]
        return effort_explained(model, model.terms[-1].name, physics, self.values, record, prediction)
