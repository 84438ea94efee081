"""Of two frictions that were found one after the other, the flexible one gives way to a simpler one
(simulated carriage)."""

from __future__ import annotations

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.search.simpler import simplified
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.trial import attempt

LIBRARY = tuple(map(effect_named, ("coulomb", "asymmetric_viscous", "stribeck")))


@pytest.fixture(scope="module")
def found(make_model, split_of):
    """A search that took a Stribeck peak for Coulomb friction, then a drag that is there; its context."""
    split = split_of(f_v=0.0, drag=900.0)
    final, accepted = refit(make_model(("offset",)), split, factors=CONTINUATION), []
    for name in ("stribeck", "quadratic_drag"):
        trial = attempt(Candidate(effect_named(name), "carriage"), final, split)
        final, accepted = trial.refit, [*accepted, Accepted(trial, (trial,), ())]
    return Search((), final, tuple(accepted), ""), Context(split, LIBRARY)


def test_an_effect_of_one_parameter_that_is_as_good_takes_the_place_of_one_of_two(found):
    search, context = found
    simpler = simplified(search, lambda new, old: new.cost <= 1.01 * old.cost, context)
    assert [one.name for one in simpler.accepted] == ["carriage.coulomb", "carriage.quadratic_drag"]
    assert {term.name for term in simpler.final.model.terms} == {
        "carriage.offset", "carriage.coulomb", "carriage.quadratic_drag",
    }  # fmt: skip
    assert simpler.final.values["carriage.coulomb.f_c"] == pytest.approx(20.4, rel=0.02)


def test_what_is_not_as_good_changes_nothing(found):
    search, context = found
    same = simplified(search, lambda new, old: False, context)
    assert (same.final, same.accepted) == (search.final, search.accepted)
    tried = [t.candidate.effect.id for step in same.steps for t in step.trials]
    assert tried == ["coulomb", "asymmetric_viscous"], "each counts in the family of tests"
