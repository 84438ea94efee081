"""``Hybrid``: the interface of every gray box with a residual model."""

from __future__ import annotations

import abc

from hybridid.records.record import Record
from hybridid.residuals.explained import Explained
from hybridid.validation.predict import Prediction


class Hybrid(abc.ABC):
    """A gray box plus a network for its error.

    Its predictions have the type of the gray box' own, so that metrics, tests and figures accept both. A
    simulation uses no measured signal except the inputs, and the outputs to estimate the initial state.
    """

    @property
    @abc.abstractmethod
    def name(self) -> str:
        """A short description such as ``hybrid, RBF with 8 nodes``."""

    @property
    @abc.abstractmethod
    def provenance(self) -> str:
        """Whether the network learned from ``measured`` or ``simulated`` records, or both."""

    @abc.abstractmethod
    def free_run(
        self, record: Record, initial_state: str = "estimated", integrator: str = "rk4"
    ) -> Prediction:
        """Simulate the whole record; see ``hybridid.validation.free_run``.

        Raises:
            Diverged: if the gray box or the network diverges; the message says when.
        """

    @abc.abstractmethod
    def horizon_run(self, record: Record, horizon: int, integrator: str = "rk4") -> Prediction:
        """Simulate each horizon of ``horizon`` samples from its own estimated initial state.

        Raises:
            Diverged: if the gray box or the network diverges; the message says when.
        """

    @abc.abstractmethod
    def explained(self, record: Record, integrator: str = "rk4") -> Explained:
        """How much of the network's output along ``record`` the physical parameters could have explained."""
