"""Before and after: the declared and the augmented model, refitted on all fitted records, scored on all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators import Estimate, FitSettings, fit
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.chosen import EXPLICIT
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import MOST, TooStiff
from hybridid.trace.context import Context
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.verdict import Conclusion
from hybridid.validation import Metrics, Prediction, diverged, free_run, horizon_run, metrics

Array = NDArray[np.float64]
BEFORE, AFTER = "gray box", "gray box + effects"
"""What the two models are called wherever a person reads of them."""
FITTED, HELD_OUT = "fitted", "held out"
"""The roles of a record."""


@dataclass(frozen=True, kw_only=True)
class ScoreRow(Metrics):
    """Error measures of one output of one record in one view, in SI units.

    ``view`` is ``free_run`` or ``horizon``, with ``horizon`` its length in s. ``role`` of the record is
    ``fitted`` or ``held out``. ``network``: the network of the completeness check runs beside the model. The
    scores are nan where the model cannot be simulated; then ``remark`` says why.
    """

    role: str
    network: bool


@dataclass(frozen=True, eq=False)
class Validation:
    """How a model is refitted and scored.

    ``settings`` are those of the refit on ``fitted``. Every record, also of ``others``, is predicted in free
    run from its ``initial_state`` ("estimated" or "measured"), and over horizons of ``seconds``.
    """

    fitted: tuple[Record, ...]
    others: tuple[Record, ...]
    settings: FitSettings
    seconds: float
    initial_state: str = "estimated"


@dataclass(frozen=True, eq=False)
class FittedModel:
    """A model with all its parameters refitted, and what it predicts of every record."""

    name: str
    model: Model
    estimate: Estimate
    rows: tuple[ScoreRow, ...]
    predictions: tuple[Prediction, ...]

    def over_horizons(self, record: str) -> Prediction | None:
        """The prediction of ``record`` over horizons, if there is one."""
        found = [p for p in self.predictions if (p.record, p.view) == (record, "horizon")]
        return found[0] if found else None


def before_and_after(found: Conclusion, validation: Validation, context: Context) -> list[FittedModel]:
    """The declared model and, if anything was accepted, the augmented one.

    The augmented model holds the declared one, so its fit cannot be worse. Where it is, its descent ended
    beside the minimum: it begins again at the declared model, with the effects at zero.
    """
    bases = {BEFORE: found.search.first} | ({AFTER: found.search.final} if found.accepted else {})
    places = [
        (name, base.model, base.values, _solved_as(base, validation), _states(base, validation, context))
        for name, base in bases.items()
    ]
    models = context.each("before and after", refitted, places, lambda one: one.name)
    if len(models) < 2 or models[1].estimate.cost <= models[0].estimate.cost:
        return models
    before, after = models
    nothing = {
        f"{term.name}.{p.name}": 0.0
        for term in after.model.terms[len(before.model.terms) :]
        for p in term.effect.parameters
        if p.nests and not p.fixed
    }
    start = {**after.estimate.values, **before.estimate.values, **nothing}
    again = context.one(refitted, AFTER, after.model, start, validation)
    return [before, min(after, again, key=lambda one: one.estimate.cost)]


def _solved_as(base: Refit, validation: Validation) -> Validation:
    """``validation`` in the steps of ``base`` where these are more than a fit chooses by itself."""
    numerics = base.numerics
    if numerics.integrator != EXPLICIT or base.steps <= MOST:
        return validation
    steps = replace(validation.settings, integrator=EXPLICIT, substeps=base.substeps)
    return replace(validation, settings=steps)


def _states(base: Refit, validation: Validation, context: Context) -> Array:
    """The initial states (w, n_x) of the horizons of the fitted records in ``base``."""
    origins = base.problem(context.split).windows.origin
    return base.x0[[index < len(validation.fitted) for index, *_ in origins]]


def refitted(
    name: str,
    model: Model,
    values: Mapping[str, float],
    validation: Validation,
    states: Array | None = None,
) -> FittedModel:
    """Refit ``model`` from ``values``, and from ``states`` (w, n_x) where they fit better than those at hand,
    on all fitted records; score it on every record, in both views."""
    settings = replace(validation.settings, continuation=(1.0,), starts=1)
    estimate = fit(model, validation.fitted, settings, start_values=values, start_states=states)
    as_fitted = replace(validation, settings=replace(estimate.settings, substeps=estimate.substeps))
    rows, predictions = scored(name, model, estimate.values, as_fitted)
    return FittedModel(name, model, estimate, rows, predictions)


def scored(
    name: str, model: Model, values: Mapping[str, float], validation: Validation, network: bool = False
) -> tuple[tuple[ScoreRow, ...], tuple[Prediction, ...]]:
    """Scores and predictions of ``model`` at ``values`` on every record, in both views."""
    rows: list[ScoreRow] = []
    predictions: list[Prediction] = []
    for role, records in ((FITTED, validation.fitted), (HELD_OUT, validation.others)):
        for record in records:
            for horizon in (None, validation.seconds):
                try:
                    prediction = _predicted(model, values, record, horizon, validation)
                except (Diverged, TooStiff) as error:
                    found = diverged(record, model.outputs, name, str(error), horizon)
                else:
                    predictions.append(prediction)
                    found = metrics(prediction, name, horizon)
                rows += [ScoreRow(**vars(row), role=role, network=network) for row in found]
    return tuple(rows), tuple(predictions)


def _predicted(
    model: Model, values: Mapping[str, float], record: Record, horizon: float | None, how: Validation
) -> Prediction:
    integrator, substeps = how.settings.integrator, how.settings.substeps
    if horizon is None:
        return free_run(model, values, record, how.initial_state, integrator, substeps)
    return horizon_run(model, values, record, round(horizon / record.dt), integrator, substeps)
