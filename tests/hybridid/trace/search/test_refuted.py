"""Members of a class that the records refute where the last model meets the noise (simulated carriage)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.search.refuted import _refuted, without_refuted
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.trial import attempt

TWIN = replace(effect_named("coulomb"), id="twin", look_alikes=("coulomb",))


@pytest.fixture(scope="module")
def context(split_of):
    return Context(split_of(), ())


@pytest.fixture(scope="module")
def found(make_model, context):
    """As if Coulomb friction, which the carriage has, were one class with a brake and its own twin."""
    base = refit(make_model(("viscous", "offset")), context.split)
    effects = (effect_named("coulomb"), effect_named("eddy_brake"), TWIN)
    tried = tuple(attempt(Candidate(one, "carriage"), base, context.split) for one in effects)
    assert context.meets_noise(tried[0].refit.score)
    return Search((), tried[0].refit, (Accepted(tried[0], tried, ()),), "")


def test_a_misfit_leaves_the_class_and_what_explains_as_much_stays(found, context):
    (one,) = without_refuted(found, context).accepted
    assert [t.candidate.effect.id for t in one.alike] == ["coulomb", "twin"]


def test_where_something_is_missing_nothing_is_refuted(found, context, monkeypatch):
    monkeypatch.setattr(Context, "meets_noise", lambda self, score: False)
    assert without_refuted(found, context) is found


@pytest.fixture
def close(found, context):
    """``close(share)``: as if a member left that share of error more than the final model, more or less."""

    def make(share):
        final, more = found.final, (1.0 + share) ** 2
        about = np.random.default_rng(0).uniform(0.99, 1.01, final.score.block_squares.shape)
        score = replace(
            final.score,
            squares=more * final.score.squares,
            block_squares=more * about * final.score.block_squares,
        )
        return replace(final, score=score, cost=more * final.cost)

    return make


def test_a_small_difference_counts_if_it_is_significant_fitted_and_no_error_of_the_simulation(
    found, context, close, monkeypatch
):
    monkeypatch.setattr("hybridid.trace.search.refuted.smoothed_apart", lambda *given: False)
    errs = 0.0 * found.final.score.rmse
    monkeypatch.setattr("hybridid.trace.search.refuted.simulation_error", lambda one, context: errs)
    other = close(0.01)
    assert _refuted(other, found.final, 1, context)
    assert not _refuted(replace(other, cost=found.final.cost), found.final, 1, context), (
        "as good where fitted"
    )
    assert not _refuted(replace(other, converged=False), found.final, 1, context)
    assert not _refuted(other, found.final, 10**40, context), "not significant among so many"
    errs = 0.1 * found.final.score.rmse  # its square, four times, is more than 2 % of the noise's
    assert not _refuted(other, found.final, 1, context)
    assert _refuted(close(0.05), found.final, 1, context)


def test_what_a_narrower_smoothing_no_longer_tells_apart_stays(found, context, close, monkeypatch):
    monkeypatch.setattr("hybridid.trace.search.refuted.smoothed_apart", lambda *given: True)
    assert not _refuted(close(0.2), found.final, 1, context)
