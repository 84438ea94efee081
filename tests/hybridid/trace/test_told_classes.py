"""A member of a class is told with the share of the smoothing in its standard errors (simulated carriage)."""

from __future__ import annotations

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.constancy import with_smoothing
from hybridid.trace.context import Context
from hybridid.trace.refit import CONTINUATION, refit
from hybridid.trace.steps import Accepted
from hybridid.trace.told_classes import with_told_errors
from hybridid.trace.trial import attempt


@pytest.fixture(scope="module")
def tried(make_model, split_of):
    """Trials of two frictions beside a carriage that is declared without Coulomb friction; their context."""
    split = split_of()
    base = refit(make_model(("viscous", "offset")), split, factors=CONTINUATION)
    trials = [attempt(Candidate(effect_named(n), "carriage"), base, split) for n in ("coulomb", "stribeck")]
    return trials, Context(split, ())


def test_each_member_is_told_with_the_share_of_the_smoothing(tried):
    (coulomb, stribeck), context = tried
    (one,) = with_told_errors([Accepted(coulomb, (coulomb, stribeck), ())], context)
    assert [t.candidate for t in one.alike] == [coulomb.candidate, stribeck.candidate]
    assert one.trial is coulomb
    for before, after in zip((coulomb, stribeck), one.alike, strict=True):
        assert after.refit.std == with_smoothing(before.refit, context.split).std
        assert all(after.refit.std[name] >= std for name, std in before.refit.std.items())


def test_an_effect_that_is_alone_stays_as_it_is(tried):
    (coulomb, _), context = tried
    alone = Accepted(coulomb, (coulomb,), ())
    assert with_told_errors([alone], context) == (alone,)
