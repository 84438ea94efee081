"""A gray box whose output error a NARX network predicts: ``y = y_gray + e`` (thesis Eqs. 4-16, 5-12)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hybridid.hybrid.hybrid import Hybrid
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.residuals.explained import Explained, Same, output_explained
from hybridid.residuals.narx import NARX
from hybridid.residuals.series import surroundings
from hybridid.simulation.simulate import Diverged
from hybridid.validation.predict import Prediction, free_run, horizon_run

Array = NDArray[np.float64]


@lru_cache(maxsize=4)
def _gray_run(
    model: Same[Model], values: tuple[tuple[str, float], ...], record: Record, integrator: str
) -> Prediction:
    """The gray box' free run, kept for further networks on the same gray box."""
    return free_run(model.value, dict(values), record, integrator=integrator)


@dataclass(frozen=True, eq=False)
class OutputErrorHybrid(Hybrid):
    """``model`` at ``values``, with at most one network for each output.

    Raises:
        ValueError: if there is no network, a network's output is not one of the model's, or two networks
            have the same output.
    """

    model: Model
    values: Mapping[str, float]
    networks: tuple[NARX, ...]

    def __post_init__(self) -> None:
        outputs = [signal.name for signal in self.model.outputs]
        given = [network.output for network in self.networks]
        if not given or len(set(given)) < len(given) or not set(given) <= set(outputs):
            raise ValueError(
                f"networks for {', '.join(given) or 'nothing'}: one at most for each of {', '.join(outputs)}"
            )

    @property
    def name(self) -> str:
        sizes = {f"{n.architecture.depth} x {n.architecture.width}" for n in self.networks if n.members}
        if not sizes:
            return "gray box, no network kept"
        return f"hybrid, NARX {' and '.join(sorted(sizes))}"

    @property
    def provenance(self) -> str:
        return " and ".join(sorted({network.provenance for network in self.networks}))

    def free_run(
        self, record: Record, initial_state: str = "estimated", integrator: str = "rk4"
    ) -> Prediction:
        return self.corrected(free_run(self.model, self.values, record, initial_state, integrator), record)

    def horizon_run(self, record: Record, horizon: int, integrator: str = "rk4") -> Prediction:
        return self.corrected(horizon_run(self.model, self.values, record, horizon, integrator), record)

    def corrected(self, prediction: Prediction, record: Record) -> Prediction:
        """The gray box' prediction of ``record`` with the networks' errors added."""
        return replace(prediction, predicted=prediction.predicted + self.correction(prediction, record))

    def correction(self, prediction: Prediction, record: Record) -> Array:
        """The networks' errors along a gray box' prediction, (n, n_y); zero for an output without one.

        Raises:
            Diverged: if a network diverges.
        """
        found = np.zeros_like(prediction.predicted)
        for network in self.networks:
            run = network.free_run(surroundings(prediction, record, network.output))
            if run.diverged_at is not None:
                raise Diverged(
                    f"the network for {network.output} diverged on record {record.name} at t = "
                    f"{record.time[0] + run.diverged_at:.4g} s: |error| above {run.limit:.3g} {run.unit}, "
                    "far beyond what trained it"
                )
            found[:, prediction.output_names.index(network.output)] = run.error
        return found

    def explained(self, record: Record, integrator: str = "rk4") -> Explained:
        prediction = _gray_run(Same(self.model), tuple(self.values.items()), record, integrator)
        correction = self.correction(prediction, record)
        return output_explained(self.model, self.values, record, prediction, correction, integrator)
