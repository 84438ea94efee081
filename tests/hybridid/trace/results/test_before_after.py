"""The declared and the augmented model on every record, the network beside them, and what is left."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.estimators import FitSettings
from hybridid.simulation.stability import MOST
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import by_record
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.results.before_after import (
    AFTER,
    BEFORE,
    Validation,
    _solved_as,
    before_and_after,
    refitted,
    scored,
)
from hybridid.trace.results.completeness import WithNetwork, completeness
from hybridid.trace.rules import Rules
from hybridid.trace.run import _solving
from hybridid.trace.verdict import conclude

DF_V, HORIZON = 80.0, 0.25  # N s/m, s


@pytest.fixture(scope="module")
def records(two_records):
    return two_records(df_v=DF_V)


@pytest.fixture(scope="module")
def context(records):
    first, second = records
    tried = (effect_named("asymmetric_viscous"), effect_named("quadratic_drag"))
    split = by_record([first], [second], round(HORIZON / first.dt))
    return Context(split, tried, variables=("velocity", "position"))


@pytest.fixture(scope="module")
def found(make_model, context):
    return conclude(make_model(), context)


@pytest.fixture(scope="module")
def validation(records, context):
    first, second = records
    settings = FitSettings(method="gauss_newton", horizon=context.split.horizon)
    return Validation((first,), (second,), settings, HORIZON)


def test_both_models_are_scored_on_every_record_in_both_views(found, validation, context):
    before, after = before_and_after(found, validation, context)
    assert (before.name, after.name) == (BEFORE, AFTER)
    seen = [(row.record, row.role, row.view) for row in after.rows]
    views = ("free_run", "horizon")
    roles = (("first", "fitted"), ("second", "held out"))
    assert seen == [(record, role, view) for record, role in roles for view in views]
    held_out = [one.rows[-1].rmse for one in (before, after)]
    assert held_out[1] < 0.2 * held_out[0]
    assert after.estimate.values["carriage.asymmetric_viscous.df_v"] == pytest.approx(DF_V, rel=0.02)
    assert after.over_horizons("second") is not None


def test_a_model_that_diverges_has_no_scores_but_says_why(found, validation):
    values = {**found.search.first.values, "carriage.viscous.f_v": -3e4}  # N s/m: it drives
    rows, predictions = scored("bad", found.search.first.model, values, validation)
    bad = [row for row in rows if math.isnan(row.rmse)]
    assert bad
    assert all(row.remark and math.isnan(row.mse) and math.isnan(row.r2) for row in bad)
    assert len(predictions) == len(rows) - len(bad)


@pytest.mark.parametrize(("searched_with", "allowed"), [("rk4", "auto"), ("rodas3", "rodas3")])
def test_a_model_too_stiff_for_rk4_is_fitted_and_predicted_by_the_implicit_one(
    found, validation, searched_with, allowed
):
    """What was accepted may make it so: a search with RK4 leaves the integrator open."""
    assert _solving(searched_with) == allowed
    settings = replace(validation.settings, integrator=_solving(searched_with))
    values = {**found.search.first.values, "carriage.viscous.f_v": 1e8}  # N s/m: it hardly moves
    model, how = found.search.first.model, replace(validation, settings=settings)
    assert refitted("stiff", model, values, how).estimate.values
    rows, predictions = scored("stiff", model, values, how)
    assert all(math.isfinite(row.rmse) for row in rows)
    assert len(predictions) == len(rows)


@pytest.mark.parametrize(
    ("gain", "p_value", "complete"),
    [(0.2, 1e-6, False), (0.2, 0.2, True), (0.04, 1e-6, True), (-0.1, 1.0, True)],
)
def test_the_check_is_complete_unless_a_gain_is_worth_having_and_significant(found, gain, p_value, complete):
    ceiling = Ceiling("carriage", Over("velocity"), gain, p_value, (), "N", "m/s", found.search.final)
    before = replace(ceiling, gain=0.6)
    check = completeness([WithNetwork(before, ()), WithNetwork(ceiling, ())], Rules())
    assert check is not None
    assert (check.complete, check.gain, check.gain_before) == (complete, gain, 0.6)
    assert check.network == "12 radial basis functions over velocity at carriage"
    other = replace(before, over=Over("position"))
    check = completeness([WithNetwork(other, ()), WithNetwork(ceiling, ())], Rules())
    assert (check.network, check.network_before) == tuple(
        f"12 radial basis functions over {over} at carriage" for over in ("velocity", "position")
    )


def test_without_effort_ports_there_is_nothing_to_check():
    assert completeness([], Rules()) is None


def test_an_augmented_model_that_fits_worse_begins_again_at_the_declared_one(make_model):
    """It holds the declared model, so its descent ended beside the minimum. The others begin at the initial
    states of the search, of the fitted record alone."""
    declared = make_model(("viscous",))
    augmented = declared.plus(effect_named("offset"), "carriage")
    values = {p.name: 7.0 for p in augmented.parameters}
    fits = {BEFORE: [2.0], AFTER: [3.0, 1.0]}
    begun = []

    def fitted(name, model, start, validation, states=None):
        begun.append((name, start.get("carriage.offset.offset"), None if states is None else states.tolist()))
        return SimpleNamespace(
            name=name, model=model, estimate=SimpleNamespace(cost=fits[name].pop(0), values=values)
        )

    context = SimpleNamespace(
        each=lambda stage, function, places, label: [fitted(*place) for place in places],
        one=lambda function, *given: fitted(*given),
        split=None,
    )
    windows = SimpleNamespace(origin=[(0, 0, 10), (1, 0, 10)])  # of the fitted and of the held-out record
    shown = {"problem": lambda split: SimpleNamespace(windows=windows), "x0": np.array([[0.1], [0.2]])}
    shown |= {"numerics": DECLARED, "steps": 2}
    first, final = (SimpleNamespace(model=one, values=values, **shown) for one in (declared, augmented))
    search, validation = SimpleNamespace(first=first, final=final), SimpleNamespace(fitted=("first",))
    before, after = before_and_after(SimpleNamespace(search=search, accepted=True), validation, context)
    assert (before.estimate.cost, after.estimate.cost) == (2.0, 1.0)
    assert begun == [(BEFORE, 7.0, [[0.1]]), (AFTER, 7.0, [[0.1]]), (AFTER, 0.0, None)]


@pytest.mark.parametrize(
    ("steps", "numerics", "own"),
    [
        (MOST + 2, DECLARED, True),
        (MOST, DECLARED, False),
        (MOST + 2, replace(DECLARED, finer=2), False),  # twice the steps that it needs
        (MOST + 2, replace(DECLARED, integrator="rodas3"), False),
    ],
)
def test_more_steps_than_a_fit_chooses_are_those_of_the_search(found, validation, steps, numerics, own):
    base = replace(found.search.first, substeps=steps, numerics=numerics)
    settings = _solved_as(base, validation).settings
    wanted = ("rk4", steps) if own else (validation.settings.integrator, None)
    assert (settings.integrator, settings.substeps) == wanted
