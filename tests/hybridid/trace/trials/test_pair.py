"""How a pair is judged, and how its starts are made, on numbers that are written down here."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.evidence import Comparison
from hybridid.trace.rules import Rules
from hybridid.trace.trials.pair import PairTrial, judge_pairs
from hybridid.trace.trials.trial import PASSED, REJECTED, UNTRIED, Trial

SPRING, OFFSET = (Candidate(effect_named(name), "carriage") for name in ("linear_stiffness", "offset"))
FAMILY = 66 * 65 // 2
SOLVED = SimpleNamespace(ended_early=False, std={}, values={})


def pair(p=1e-9, gain=0.5, p_members=(1e-9, 1e-9), gains=(0.4, 0.3)):
    members = tuple(
        Trial(candidate, SOLVED, Comparison(g, q, 1.0), not_shown="its period is not shown")
        for candidate, g, q in zip((SPRING, OFFSET), gains, p_members, strict=True)
    )
    return PairTrial((SPRING, OFFSET), 0.5, SOLVED, Comparison(gain, p, 1.0), members)


def only(one, family=FAMILY):
    (judged,) = judge_pairs([one], family, Rules())
    return judged


@pytest.mark.parametrize("worst", [0, 1, 2])
def test_the_largest_of_three_p_values_counts_times_all_pairs(worst):
    p_values = [1e-9, 1e-8, 1e-10]
    p_values[worst] = 3e-7
    judged = only(pair(p_values[0], p_members=p_values[1:]))
    assert judged.p_adjusted == pytest.approx(FAMILY * 3e-7)
    assert [member.p_adjusted for member in judged.members] == [judged.p_adjusted] * 2
    p_values[worst] = 1e-5
    judged = only(pair(p_values[0], p_members=p_values[1:]))
    assert judged.status == REJECTED
    assert judged.reason == "not significant: adjusted p = 0.021 over 0.01"
    assert only(pair(p_values[0], p_members=p_values[1:]), family=10).p_adjusted == pytest.approx(1e-4)


def test_each_member_must_be_needed_beside_the_other():
    judged = only(pair(gains=(0.5, 0.01)))
    assert judged.status == REJECTED
    assert judged.reason == (
        "beside carriage.linear_stiffness, carriage.offset changes the held-out RMSE by −1.0 %; 5 % less is "
        "asked of each"
    )


def test_a_pair_must_be_worth_having():
    judged = only(replace(pair(gain=0.04), members=()))
    assert judged.status == REJECTED
    assert judged.reason == "held-out RMSE changes by −4.0 %; 5 % less is asked"


def test_the_rules_of_single_effects_hold_for_each_member():
    judged = only(pair())
    assert judged.status == "unidentifiable"
    assert judged.reason == "carriage.linear_stiffness: its period is not shown"


def test_what_could_not_be_fitted_is_untried():
    failed = PairTrial((SPRING, OFFSET), 0.5, None, failure="too stiff")
    assert (only(failed).status, only(failed).reason) == (UNTRIED, "could not be fitted: too stiff")
    assert only(failed).name == "carriage.linear_stiffness + carriage.offset"
    assert PASSED not in {one.status for one in judge_pairs([failed, failed], FAMILY, Rules())}
