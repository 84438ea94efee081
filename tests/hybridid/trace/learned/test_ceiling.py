"""On simulated carriages: a learned effort knows nothing beyond the range that it was fitted on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.over import Over
from hybridid.trace.context import Context
from hybridid.trace.laws.laws import with_law
from hybridid.trace.learned.ceiling import LEAST_WITHIN, _inside, ceiling
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Search

SLOPE = 6000.0  # N s/m²
DAMPING = Over("position", "velocity")


@pytest.fixture(scope="module")
def split(split_of):
    """Viscous friction that rises from place to place. The record that judges goes where the other one did
    not."""
    return split_of(damping_slope=SLOPE)


@pytest.fixture(scope="module")
def base(make_model, split):
    return refit(make_model(), split)


@pytest.fixture(scope="module")
def learned(base, split):
    return ceiling(base, split, "carriage", DAMPING, 0.0)


def test_the_horizons_within_the_range_are_told(base, split):
    fitted = Path.of(base, split, split.fitted).seen("carriage", DAMPING)
    inside = _inside(base, split, "carriage", DAMPING, fitted)
    margin = 0.1 * np.ptp(fitted)
    paths = [Path.of(base, split, [h]).seen("carriage", DAMPING) for h in split.held_out]
    within = [fitted.min() - margin <= one.min() and one.max() <= fitted.max() + margin for one in paths]
    assert inside.tolist() == within
    assert 0 < inside.sum() < len(inside)


def test_a_learned_effort_is_not_refuted_beyond_its_range(learned, base):
    rules = Rules()
    assert learned.beyond
    assert learned.within > 1 - rules.stands_in
    assert learned.untested(rules)
    assert learned.taken(base) < learned.most(base, rules) == learned.within * base.score.loss**2
    known = replace(learned, beyond=False)
    assert not known.untested(rules)
    assert known.most(base, rules) == known.taken(base)


def test_within_its_range_it_is_judged_by_what_was_not_fitted(base, split):
    """Over the time the two records are alike, and nothing is missing."""
    other = ceiling(base, split, "carriage", Over("time"), 0.0)
    assert not other.beyond
    assert len(split.held_out) >= LEAST_WITHIN
    assert other.within == pytest.approx(1 - (other.refit.score.loss / base.score.loss) ** 2)
    assert other.within < 0.1


def test_a_law_that_goes_on_beyond_the_range_is_tried_and_proposed(learned, base, split):
    context = Context(split, (), variables=("position",))
    known = replace(learned, gain=0.0, p_value=1.0)  # as if the held-out error had not fallen
    proposed = with_law(Search((), base, (), ""), [known], context)
    (one,) = proposed.accepted
    assert one.name == "carriage.proportional_of_position_times_velocity"
    assert one.trial.own("values")["k"] == pytest.approx(SLOPE, rel=0.01)
    refuted = replace(known, within=0.0)
    assert with_law(Search((), base, (), ""), [refuted], context).accepted == ()
