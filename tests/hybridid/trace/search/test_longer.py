"""Over horizons of a few samples a fitted initial state takes up what a missing effort does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import by_blocks, by_record
from hybridid.trace.refits.declared_starts import declared_starts
from hybridid.trace.refits.numerics import numerics_for
from hybridid.trace.refits.refit import CONTINUATION, refit, refit_if_possible
from hybridid.trace.run import trace
from hybridid.trace.search.longer import (
    _begun_as,
    _bounded,
    more_over_longer,
    over_long_enough,
    shows_little,
    worth_looking_for,
)
from hybridid.trace.starts.solve import declared_refit
from hybridid.trace.verdict import conclude

EPSILON = 3e-3  # m/s, with which the records are simulated
SHORT = 10  # samples, 0.05 s
LONGER = 25  # samples
DF_V = 20.0
TRIED = (effect_named("asymmetric_viscous"),)


@pytest.fixture(scope="module")
def short(two_records):
    """Horizons over which nothing is missing, and over which what is missing stays within the noise."""
    return {df_v: by_record(*([one] for one in two_records(df_v=df_v)), SHORT) for df_v in (0.0, DF_V)}


@pytest.mark.parametrize(("df_v", "verdict"), [(0.0, "nothing_missing"), (DF_V, "undecided")])
def test_nothing_is_missing_only_if_longer_horizons_agree(make_model, short, df_v, verdict):
    found = conclude(make_model(), Context(short[df_v], TRIED, variables=("velocity",)))
    assert found.verdict == verdict
    assert (found.longer is None) is (df_v == 0.0)
    if found.longer:
        assert found.longer.seconds == pytest.approx(0.5)
        assert found.longer.times > 3.0


def test_a_fit_over_longer_ones_that_has_not_converged_says_nothing(make_model, short, monkeypatch):
    split, model = short[DF_V], make_model()
    base = refit(model, split, factors=CONTINUATION)
    assert more_over_longer(base, Context(split, TRIED)) is not None

    def stopped(*given):
        return replace(refit_if_possible(*given), converged=False)

    monkeypatch.setattr("hybridid.trace.search.longer.refit_if_possible", stopped)
    unknown = replace(base, model=replace(model))  # what is left is kept with a model
    assert more_over_longer(unknown, Context(split, TRIED)) is None


@pytest.mark.parametrize(("how", "doubt"), [("guess", False), ("fixed", True)])
def test_what_an_inexact_smoothing_leaves_over_longer_ones_is_no_doubt(
    make_model, short, monkeypatch, how, doubt
):
    """A machine that breaks away a little too early is elsewhere from then on, unless epsilon is fitted over
    these horizons, too. One that the user has fixed stays."""
    split, asked = short[0.0], []
    base = refit(make_model(adjust={"carriage.epsilon": {how: EPSILON}}), split, factors=CONTINUATION)

    def left(split, final, context):
        (width,) = [p for p in final.model.parameters if p.name == "carriage.epsilon"]
        asked.append(width)
        return 50.0 if width.fixed else 1.0

    monkeypatch.setattr("hybridid.trace.search.longer._left_over", left)
    found = more_over_longer(base, Context(split, TRIED))
    assert (found is not None) is doubt
    assert all(width.fixed for width in asked) is doubt
    assert doubt or (asked[-1].lower, asked[-1].upper) == (EPSILON / 2, EPSILON)


def test_what_cannot_be_asked_is_no_doubt(make_model, short):
    """Four horizons on either side are the fewest: none longer is left."""
    split = by_record(*([one.part(0, 4 * SHORT)] for one in short[DF_V].records), SHORT)
    base = refit(make_model(), split, factors=CONTINUATION)
    assert more_over_longer(base, Context(split, TRIED)) is None


@pytest.mark.parametrize("df_v", [0.0, DF_V])
def test_where_too_few_longer_ones_are_held_out_the_fitted_ones_are_asked(make_model, short, df_v):
    """Five brief horizons are held out. What the others hide in their initial states shows over longer ones,
    though it cannot be judged."""
    first, second = short[df_v].records
    split = by_record([first], [second.part(0, 5 * LONGER)], LONGER)
    base = refit(make_model(), split, factors=CONTINUATION)
    found = more_over_longer(base, Context(split, TRIED))
    assert (found is None) is (df_v == 0.0)
    if found:
        assert not found.judged
        assert found.seconds == pytest.approx(2 * LONGER * first.dt)


def test_a_longer_horizon_begins_as_the_shorter_one_at_its_place_ended_its_fit(make_model, short):
    """Else as the record shows it."""
    split = short[0.0]
    base = refit(make_model(), split)
    twice = split.longer(2 * SHORT)
    assert np.array_equal(_begun_as(base, split, twice).x0, base.x0[::2])
    odd = split.longer(int(2.5 * SHORT))
    begun, shown = _begun_as(base, split, odd).x0, base.problem(odd).measured_x0()
    assert np.array_equal(begun[1], shown[1])  # 25 samples on, no shorter one begins
    assert np.array_equal(begun[2], base.x0[5])


def test_horizons_over_which_a_disturbance_grows_too_far_are_not_asked(make_model, short):
    """A model that falls from a hill-top is asked over horizons up to e⁵ alone."""
    split, model = short[0.0], make_model(("viscous", "linear_stiffness"))
    base = refit(model, split, [{"carriage.linear_stiffness.k": 0.0}])
    seconds = SHORT * split.records[0].dt
    hill = {**base.values, "M": 90.0, "carriage.viscous.f_v": 0.0}
    unstable = replace(base, values={**hill, "carriage.linear_stiffness.k": -90.0 * (3.9 / seconds) ** 2})
    assert _bounded([split, split.longer(2 * SHORT)], unstable) == [split]
    assert len(_bounded([split, split.longer(2 * SHORT)], base)) == 2


def test_longer_horizons_are_divided_in_the_same_way(short):
    split = short[0.0]
    assert split.longer(50).described == split.described
    assert split.longer(50).horizon == 50
    blocks = by_blocks(split.records, SHORT)
    assert blocks.longer(50).held_out == by_blocks(split.records, 50).held_out
    with pytest.raises(ValueError, match="at least 4 horizons"):
        split.longer(400)


def test_horizons_of_a_few_samples_show_little_where_the_record_has_no_longer_ones(make_model, two_records):
    brief = [one.part(0, 12 * SHORT) for one in two_records()]
    split = by_record(brief[:1], brief[1:], 3 * SHORT)
    assert not shows_little(split)
    tiny = by_record(*([one.part(0, 4 * SHORT)] for one in brief), SHORT)
    assert shows_little(tiny)
    found = conclude(make_model(), Context(tiny, TRIED, variables=("velocity",)))
    assert (found.verdict, found.too_short) == ("undecided", True)


def test_an_automatic_horizon_goes_on_to_longer_ones(make_model, two_records):
    first, second = two_records(df_v=DF_V)
    asked = {"effects": TRIED, "variables": ("velocity",), "horizon": SHORT * first.dt, "laws": False}
    said = []
    found = trace(make_model(), [first], [second], lengthen=True, say=said.append, **asked)
    stays = trace(make_model(), [first], [second], **asked)
    assert stays.horizon == pytest.approx(SHORT * first.dt)
    assert found.horizon == pytest.approx(stays.longer.seconds)
    assert any(line.endswith("the search goes on over these") for line in said)


def test_what_a_wide_smoothing_adds_up_to_over_longer_ones_lengthens_nothing(make_model, two_records):
    """The model is complete. Smoothed too widely it leaves more over longer horizons; as sharply as the
    records show it, it leaves the noise there too."""
    split = by_record(*([one] for one in two_records()), LONGER)
    model, context = make_model(adjust={"carriage.epsilon": {"guess": 0.05}}), Context(split, TRIED)
    starts = declared_starts(model, split, ())
    numerics = numerics_for(model, split, starts, "auto")
    wide = declared_refit(model, context, starts, numerics)
    assert more_over_longer(wide, context, worth_looking_for(context.rules)) is not None
    assert over_long_enough(model, context, starts, numerics) is context
