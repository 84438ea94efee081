"""An effect that makes the free run worse is told beside its name."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.trace.cautions.cautions import _in_free_run
from hybridid.trace.cautions.free_run import adds_up_in_free_run, far_in_free_run, unstable, worse_in_free_run
from hybridid.trace.entries import Floor
from hybridid.trace.results.before_after import ScoreRow
from hybridid.trace.rules import Rules


def row(rmse, record="first", view="free_run", **more):
    horizon = None if view == "free_run" else 1.0
    made = ScoreRow(
        "m", record, "position", view, rmse**2, rmse, 0.9, 90.0, 100, "m", "simulated", horizon,
        role="fitted", network=False,
    )  # fmt: skip
    return replace(made, **more)


def told(before, after, accepted=("coulomb",)):
    return worse_in_free_run(SimpleNamespace(accepted=accepted, before=before, after=after, rules=Rules()))


def test_the_worst_record_is_told():
    said = told((row(0.002), row(0.001, "second")), (row(0.004), row(0.009, "second")))
    assert said.startswith(" Beware: in free run of second the error of position grows from 1 mm to 9 mm.")


@pytest.mark.parametrize(
    "after", [row(0.0029), row(0.001), row(0.009, view="horizon"), row(0.009, network=True)]
)
def test_nothing_is_told_of_a_free_run_about_as_good(after):
    assert told((row(0.002), row(0.002, view="horizon")), (after,)) == ""


def test_nothing_is_told_where_nothing_was_accepted():
    assert told((row(0.002),), (row(0.2),), accepted=()) == ""


def test_a_free_run_that_diverges_is_told():
    said = told((row(0.002),), (row(float("nan"), remark="it diverges"),))
    assert "the error of position diverges (without them 2 mm)" in said


def far(free, horizons=2.0, drift=()):
    floor = {"position": Floor(0.001, "m", 0.0, 5.0)}
    ended = SimpleNamespace(after=(row(free),), noise_floor=floor, times=horizons, rules=Rules())
    return far_in_free_run(ended, drift)


def test_a_free_run_that_leaves_far_more_than_the_horizons_is_told():
    assert far(0.02) == (
        " Beware: in free run of first the model leaves 20 mm of position, 20 times what noise and "
        "simulation do. Longer horizons (trace.horizon) may show what is missing."
    )


def adding_up(free, horizons=1.0, accepted=("coulomb",), drift=()):
    floor = {"position": Floor(0.001, "m", 0.0, 5.0)}
    ended = {"accepted": accepted, "after": (row(free),), "noise_floor": floor, "times": horizons}
    return adds_up_in_free_run(SimpleNamespace(**ended, rules=Rules()), drift)


def test_what_was_named_at_the_noise_and_adds_up_in_free_run_is_told():
    assert adding_up(0.004) == (
        " Beware: in free run of first the model leaves 4 mm of position, 4 times what noise and simulation "
        "do. Over a long run two things add up: the errors of the parameters, and the difference between the "
        "named law and the true one."
    )
    assert adding_up(0.002) == adding_up(0.004, accepted=()) == ""
    assert adding_up(0.1, horizons=3.1) == "", "that more is missing is told already"
    assert adding_up(0.004, drift=["position"]) == "", "what it integrates drifts"


@pytest.mark.parametrize("told", [far(0.005), far(0.02, horizons=8.0), far(0.02, drift=["position"])])
def test_a_free_run_near_the_horizons_or_one_that_drifts_is_not(told):
    assert told == ""


def test_a_bad_free_run_of_an_unstable_model_says_nothing():
    good, bad = (SimpleNamespace(after=(row(3.0, r2=r2), row(0.1, "second", r2=0.9))) for r2 in (0.5, -170.0))
    assert unstable(bad, 7.1) == (
        " The model is unstable where the records hold it: a small error grows e-fold in 140 ms, so its free "
        "runs say nothing."
    )
    assert unstable(good, 7.1) == ""


@pytest.mark.parametrize(("before", "excused"), [(6.0, True), (0.0, False)])
def test_what_only_an_accepted_effect_makes_unstable_is_no_excuse(monkeypatch, before, excused):
    """A negative damping that was accepted lets the free run of a stable machine diverge."""
    rates = {"declared": before, "augmented": 7.1}
    monkeypatch.setattr("hybridid.trace.cautions.cautions.growth", lambda model, *_: rates[model.name])
    first, final = (
        SimpleNamespace(model=SimpleNamespace(name=name, values=dict), values={}) for name in rates
    )
    traced = SimpleNamespace(
        accepted=("viscous",), before=(row(0.002),), after=(row(3.0, r2=-170.0),), rules=Rules()
    )
    context = SimpleNamespace(split=SimpleNamespace(records=()))
    said = _in_free_run(SimpleNamespace(first=first, final=final), traced, (), context, still_open=False)
    assert ("its free runs say nothing" in said) is excused
    assert ("the error of position grows from 2 mm to 3 m" in said) is not excused


@pytest.mark.parametrize(("rate", "advised"), [(0.0, True), (7.1, False)])
def test_longer_horizons_are_not_advised_by_a_free_run_that_says_nothing(monkeypatch, rate, advised):
    """A crank that passes its top in one run and falls back in the other has lost nothing over horizons."""
    monkeypatch.setattr("hybridid.trace.cautions.cautions.growth", lambda *_: rate)
    model = SimpleNamespace(model=SimpleNamespace(values=dict), values={})
    floor = {"position": Floor(0.001, "m", 0.0, 5.0)}
    rows = {"accepted": (), "before": (), "after": (row(3.0, r2=-6.0),)}
    traced = SimpleNamespace(**rows, noise_floor=floor, times=1.0, rules=Rules())
    context = SimpleNamespace(split=SimpleNamespace(records=()))
    search = SimpleNamespace(first=model, final=model)
    said = _in_free_run(search, traced, (), context, still_open=True)
    assert ("Longer horizons (trace.horizon) may show" in said) is advised
    assert ("its free runs say nothing" in said) is not advised
