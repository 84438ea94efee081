"""``Hybrid``: what every gray box with a residual model can do."""

from __future__ import annotations

import abc

from hybridid.records.record import Record
from hybridid.residuals.explained import Explained
from hybridid.validation.predict import Prediction


class Hybrid(abc.ABC):
    """A gray box plus a network on what it leaves.

    Its predictions have the shape of the gray box' own, so that metrics, tests and figures take
    them alike. Nothing measured enters a simulation but the inputs and, where it is estimated,
    the initial state.
    """

    @property
    @abc.abstractmethod
    def name(self) -> str:
        """What it is, in few words, such as ``hybrid, RBF with 8 nodes``."""

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
            Diverged: if the gray box or the network runs away; the message says when.
        """

    @abc.abstractmethod
    def horizon_run(self, record: Record, horizon: int, integrator: str = "rk4") -> Prediction:
        """Simulate each horizon of ``horizon`` samples from its own estimated initial state.

        Raises:
            Diverged: if the gray box or the network runs away; the message says when.
        """

    @abc.abstractmethod
    def explained(self, record: Record, integrator: str = "rk4") -> Explained:
        """How much of the network's output along ``record`` the physical parameters could have explained."""
