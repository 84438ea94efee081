"""Parameters that the noise has moved are no missing physics, however large the held-out motion."""

from __future__ import annotations

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.noise_floor.together import meets_noise_together
from hybridid.trace.refits.refit import refit
from hybridid.trace.search.steps import AT_FLOOR_TOGETHER
from hybridid.trace.verdict import conclude

LOUD = 1e-4  # m, as in larger_than_fitted


@pytest.mark.parametrize(("df_v", "meets"), [(0.0, True), (60.0, False)])
def test_one_fit_to_all_horizons_meets_the_noise_only_if_nothing_is_missing(
    make_model, larger_than_fitted, df_v, meets
):
    """In both cases the fitted horizons show nothing: there the noise hides a friction by direction."""
    context = Context(larger_than_fitted(judged=LOUD, df_v=df_v))
    base = refit(make_model(("viscous",)), context.split)
    assert not context.meets_noise(base.score)
    assert meets_noise_together(base, context) is meets


def test_nothing_is_named_where_only_the_parameters_are_uncertain(make_model, larger_than_fitted):
    effects = tuple(map(effect_named, ("asymmetric_viscous", "quadratic_drag", "coulomb")))
    found = conclude(make_model(("viscous",)), Context(larger_than_fitted(judged=LOUD), effects))
    assert found.verdict == "nothing_missing"
    assert found.search.stopped == AT_FLOOR_TOGETHER
    assert found.search.final.score.rmse.item() > 1.2 * LOUD
