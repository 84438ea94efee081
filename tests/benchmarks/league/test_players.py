"""The rivals of the league are no straw men, and the oracle knows what it is told. All is simulated."""

from __future__ import annotations

import pytest

from benchmarks.league import ours, play, rivals
from benchmarks.league.machines import CASES, records_of
from benchmarks.league.scenarios import all_scenarios
from hybridid.effects.over import RECENT, Over
from hybridid.trace.learned.ceiling import ceiling

ALL = {s.key: s for s in all_scenarios()}
EFFORTS = [
    s for s in ALL.values() if s.category == "clean" and s.machine == "carriage" and not s.hidden[0].on_path
]
REGRESSED = [s.key for s in EFFORTS][::7]


@pytest.mark.parametrize("key", REGRESSED)
def test_the_regression_names_what_a_clean_carriage_hides(key):
    found = rivals.regression(ALL[key], records_of(ALL[key]))
    assert found.named[:1] == (ALL[key].truth,)
    assert found.after < 0.9 * found.before


def test_the_regressions_name_nothing_where_nothing_is(nothing):
    """PySINDy knows no test of significance: what it says of an empty record is its own affair."""
    records = records_of(nothing)
    for player in (rivals.regression, rivals.own_cutoff, rivals.with_memory):
        assert player(nothing, records).named == ()


def test_the_regression_derives_what_of_a_car_is_not_measured():
    (key,) = (k for k in ALL if k.startswith("half_car/front_suspension.asymmetric_damper/large/noise0.0002"))
    found = rivals.regression(ALL[key], records_of(ALL[key]))
    assert found.named[0] == ALL[key].truth
    assert found.values["dc"] == pytest.approx(2000.0, rel=0.1)


def test_pysindy_names_a_plain_effect(drag):
    found = rivals.pysindy(*drag)
    # a brake that touches from the least speed of the rival's grid on is nearly a drag
    assert found.named[0] in ("carriage.quadratic_drag", "carriage.centrifugal_brake")
    assert found.after < 0.5 * found.before


def test_the_oracle_finds_what_it_is_told(drag, nothing):
    found = ours.consult(*drag)
    assert found is not None
    assert found.detectable
    assert found.error["carriage.quadratic_drag.c_d"] < 0.05
    assert ours.consult(nothing, records_of(nothing)) is None


def test_friction_that_warms_is_told_by_a_learned_effort():
    """No effect of the library has it; a learned effort over the recent speed of the contact does."""
    (scenario,) = play.chosen(ALL.values(), match="carriage.heating/large/noise1e-07")
    split = ours._split(scenario, records_of(scenario))
    base = ours._declared(CASES["carriage"].model(), split)
    found = ceiling(base, split, "carriage", Over(RECENT, "sign of velocity"))
    (tau,) = [value for name, value in found.refit.values.items() if name.endswith(".tau")]
    assert found.gain > 0.9
    assert found.p_value < 1e-6
    assert tau == pytest.approx(scenario.hidden[0].values["tau"], rel=0.02)
