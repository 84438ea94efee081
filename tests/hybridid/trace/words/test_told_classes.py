"""A member of a class is told as the last model has it (simulated carriage)."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.constancy import with_smoothing
from hybridid.trace.trials.trial import attempt
from hybridid.trace.words import told_classes
from hybridid.trace.words.told_classes import as_told, depends_on_the_member


@pytest.fixture(scope="module")
def tried(make_model, split_of):
    """Trials of two frictions beside a carriage that is declared without Coulomb friction; their context."""
    split = split_of()
    base = refit(make_model(("viscous", "offset")), split, factors=CONTINUATION)
    trials = [attempt(Candidate(effect_named(n), "carriage"), base, split) for n in ("coulomb", "stribeck")]
    return trials, Context(split, ())


def search(final, *accepted):
    return Search((), final, accepted, "")


def test_each_member_is_told_with_the_share_of_the_smoothing(tried):
    (coulomb, stribeck), context = tried
    found = search(coulomb.refit, Accepted(coulomb, (coulomb, stribeck), ()))
    (one,) = as_told(found, context)
    assert [t.candidate for t in one.alike] == [coulomb.candidate, stribeck.candidate]
    assert one.trial is coulomb
    for before, after in zip((coulomb, stribeck), one.alike, strict=True):
        assert after.refit.std == with_smoothing(before.refit, context.split).std
        assert all(after.refit.std[name] >= std for name, std in before.refit.std.items())


def test_an_effect_that_is_alone_stays_as_it_is(tried):
    (coulomb, _), context = tried
    alone = Accepted(coulomb, (coulomb,), ())
    assert as_told(search(coulomb.refit, alone), context) == (alone,)


@pytest.fixture(scope="module")
def beside_more(tried):
    """As if an asymmetry had been accepted after a class of Coulomb and Stribeck friction."""
    (coulomb, stribeck), context = tried
    later = attempt(Candidate(effect_named("asymmetric_viscous"), "carriage"), coulomb.refit, context.split)
    first = Accepted(coulomb, (coulomb, stribeck), ())
    return search(later.refit, first, Accepted(later, (later,), ())), context


def test_a_member_has_the_values_of_the_last_model(beside_more):
    found, context = beside_more
    one, _ = as_told(found, context)
    ours, theirs = one.alike
    assert ours.refit.values["carriage.asymmetric_viscous.df_v"] == pytest.approx(
        found.final.values["carriage.asymmetric_viscous.df_v"]
    )
    terms = {term.name for term in theirs.refit.model.terms}
    assert {"carriage.stribeck", "carriage.asymmetric_viscous"} <= terms
    assert "carriage.coulomb" not in terms
    assert all(std > 0 for std in theirs.refit.std.values())
    assert theirs.comparison is found.accepted[0].alike[1].comparison, "its gain is that of its step"


def test_a_member_whose_refit_went_astray_is_told_as_in_its_step(beside_more, monkeypatch):
    """Too stiff for the integrator at its own values, it may end in another valley."""
    found, context = beside_more
    step = found.accepted[0].alike[1].refit
    astray = replace(step, cost=50 * step.cost, values=dict.fromkeys(step.values, 1.0))
    monkeypatch.setattr(told_classes, "exchanged", lambda *_: astray)
    one, _ = as_told(found, context)
    assert one.alike[1].refit.values == step.values


def test_what_leaves_its_interval_with_another_member_is_told(beside_more):
    found, context = beside_more
    one, later = as_told(found, context)
    theirs = one.alike[1]
    known = [
        SimpleNamespace(
            name=p.name,
            value=theirs.refit.values[p.name] + moved * theirs.refit.std[p.name],
            std=theirs.refit.std[p.name],
            unit=p.unit,
            identifiable=True,
        )
        for p, moved in zip(theirs.refit.model.plant.parameters, (3.0,), strict=True)
    ]
    traced = SimpleNamespace(estimate=SimpleNamespace(parameters=known))
    told = depends_on_the_member((one, later), traced)
    assert told.startswith(
        " Beware: other parameters depend on which of the class of carriage.coulomb it is: M is between "
    )
    alone = replace(one, alike=one.alike[:1])
    assert depends_on_the_member((alone, later), traced) == "", "it is in no class"
    (near,) = known
    near.value, near.std = theirs.refit.values["M"], 1.0
    assert depends_on_the_member((one, later), traced) == ""
