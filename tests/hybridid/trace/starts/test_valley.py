"""A load behind a play, and a limit that is nearly always exceeded, are found from a wrong place, too."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import pytest

from benchmarks.drawn.oracle import split_of as judged
from benchmarks.rebuilt import machines
from benchmarks.rebuilt.draw import all_draws
from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.starts.limit_starts import PARTS, with_limit_exceeded
from hybridid.trace.starts.valley import _as_wide_as_the_valley, along_the_valley
from hybridid.trace.trials import sensitivity
from hybridid.trace.trials.trial import Trial
from hybridid.trace.trials.tried import along_valleys

PLAY = Candidate(effect_named("backlash"), "carriage")
LOAD = f"{PLAY.name}.m_l"
SATURATION = Candidate(effect_named("input_saturation"), "force")
COULOMB = Candidate(effect_named("coulomb"), "carriage")
LIMIT = f"{SATURATION.name}.inverse_limit"


@pytest.fixture(scope="module")
def behind_a_play():
    """A simulated carriage with a third of its mass behind a play: its draw, base, split and a refit that
    begins, and so ends, with too large a load."""
    draw = next(
        d for d in all_draws(8) if d.row == "backlash" and d.category == "missing" and d.kind == "sines"
    )
    case = machines.declared(draw)
    split = judged(case, machines.records_of(draw))
    base = refit(case.model(), split, [case.truth])
    mass, third = draw.parameters["M"], draw.parameters["M"] / 3
    wrong = {"M": mass - 1.4 * third, LOAD: 1.4 * third, f"{PLAY.name}.g": draw.amounts["gap"] / 2 / 1.4}
    contact = {
        f"{PLAY.name}.{n}": draw.amounts[a] for n, a in (("frequency", "frequency"), ("zeta", "damping"))
    }
    model = PLAY.added_to(base.model)
    return third, base, split, refit(model, split, [{**base.values, **wrong, **contact}], base)


def test_it_leaves_a_load_that_is_too_large(behind_a_play):
    load, base, split, wrong = behind_a_play
    assert wrong.values[LOAD] > 1.2 * load, "a descent alone finds it: this test shows nothing"
    found = along_the_valley(wrong, PLAY, base, split)
    assert found.cost < wrong.cost
    assert found.values[LOAD] == pytest.approx(load, rel=0.1)
    assert found.values["M"] == pytest.approx(2 * load, rel=0.05)


@pytest.mark.parametrize(("more", "reached"), [(0.0, True), (0.1, False)])
def test_standard_errors_reach_the_fits_that_are_as_likely(behind_a_play, more, reached):
    _, _, split, found = behind_a_play
    far = found.std[LOAD] * 3
    other = replace(
        found, cost=found.cost * (1 + more), values={**found.values, LOAD: found.values[LOAD] + far}
    )
    wider = _as_wide_as_the_valley(found, [found, other], [LOAD], split)
    assert wider.std[LOAD] == pytest.approx(far if reached else found.std[LOAD])
    assert wider.std["M"] == found.std["M"]


@pytest.mark.parametrize("name", ["flexible_mode", "coulomb"])
def test_what_has_no_play_stays(behind_a_play, name):
    _, base, split, wrong = behind_a_play
    assert along_the_valley(wrong, Candidate(effect_named(name), "carriage"), base, split) is wrong


def trial_of(found, base):
    return Trial(PLAY, found, compare(base.score, found.score))


def test_a_trial_that_its_step_may_choose_goes_on(behind_a_play):
    load, base, split, wrong = behind_a_play
    (gone,) = along_valleys([trial_of(wrong, base)], base, Context(split), "step 1")
    assert gone.gain > trial_of(wrong, base).gain
    assert gone.own("values")["m_l"] == pytest.approx(load, rel=0.1)


@pytest.mark.parametrize("why", ["another leaves far less", "it takes too little", "no time is left"])
def test_no_other_trial_goes_on(behind_a_play, why):
    _, base, split, wrong = behind_a_play
    near = replace(wrong, score=replace(base.score, squares=0.99 * base.score.squares))
    best = replace(wrong, score=replace(wrong.score, squares=wrong.score.squares / 9))
    trials = {
        "another leaves far less": [trial_of(wrong, base), replace(trial_of(best, base), candidate=COULOMB)],
        "it takes too little": [trial_of(near, base)],
        "no time is left": [trial_of(wrong, base)],
    }[why]
    context = Context(split, until=time.monotonic() - 1 if why == "no time is left" else math.inf)
    assert along_valleys(trials, base, context, "step 1") == trials


@pytest.fixture(scope="module")
def saturated():
    """A simulated carriage whose drive gives a fifth of what is asked of it nearly all the time: its draw,
    base and split."""
    draw = next(d for d in all_draws(9) if d.number == 9157)
    case = machines.declared(draw)
    split = judged(case, machines.records_of(draw))
    return draw, refit(case.model(), split), split


def test_a_limit_begins_at_parts_of_the_largest_input_with_all_else_in_proportion(saturated):
    _, base, split = saturated
    largest = max(abs(record.inputs[:, 0]).max() for record in split.fitted_records)
    starts = with_limit_exceeded(SATURATION, SATURATION.added_to(base.model), split)
    assert [1 / start[LIMIT] for start in starts] == pytest.approx([part * largest for part in PARTS])
    for name in ("M", "carriage.viscous.f_v"):
        assert starts[0][name] / starts[1][name] == pytest.approx(PARTS[0] / PARTS[1], rel=0.15)


def test_it_leaves_a_limit_that_is_too_large(saturated):
    draw, base, split = saturated
    start = with_limit_exceeded(SATURATION, SATURATION.added_to(base.model), split)[0]
    wrong = refit(SATURATION.added_to(base.model), split, [start], base, factors=CONTINUATION)
    mass = draw.parameters["M"]
    assert wrong.values["M"] > 2 * mass, "a descent alone finds it: this test shows nothing"
    found = along_the_valley(wrong, SATURATION, base, split)
    assert found.cost < wrong.cost
    assert found.values["M"] == pytest.approx(mass, rel=0.15)


def test_a_limit_that_converged_stays(saturated):
    _, base, split = saturated
    start = with_limit_exceeded(SATURATION, SATURATION.added_to(base.model), split)[2]
    there = replace(
        refit(SATURATION.added_to(base.model), split, [start], base, factors=CONTINUATION), status="converged"
    )
    assert along_the_valley(there, SATURATION, base, split) is there


def test_the_ranking_looks_at_each_limit_beside_the_base_as_it_ended(saturated, monkeypatch):
    _, base, split = saturated
    looked, problem_of = [], sensitivity.problem_of
    monkeypatch.setattr(
        sensitivity, "problem_of", lambda *given: looked.append(given[-1]) or problem_of(*given)
    )
    shown = sensitivity.seen(SATURATION, None, base, split, searched=True)
    assert len({shape.start[LIMIT] for shape in shown.shapes}) > len(PARTS)
    assert {start["M"] for start in looked} == {base.values["M"]}


def test_an_effect_without_a_limit_begins_at_none(saturated):
    _, base, split = saturated
    gain = Candidate(effect_named("input_gain"), "force")
    assert with_limit_exceeded(gain, gain.added_to(base.model), split) == []
