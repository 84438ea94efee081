"""How trials are decided, on trials whose numbers are written down here."""

from __future__ import annotations

import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.trace.candidates import Candidate, admissible
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.score import Score
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials import trial as trials
from hybridid.trace.trials.alike import equivalents
from hybridid.trace.trials.judgement import is_nothing, judge
from hybridid.trace.trials.trial import PASSED, REJECTED, UNIDENTIFIABLE, UNTRIED, Trial

RULES = Rules()
HORIZONS, SAMPLES = 20, 100
LUCKY = 0.1  # some three standard errors of the scatter


def score(rmse, likelihood, seed=0, lone=False):
    """A score with ``rmse``, four fifths of its squares in the first horizon, and a ``likelihood`` that
    scatters by 0.1. ``lone``: the other horizons err as they do at an RMSE of 1."""
    scatter = np.random.default_rng(seed).normal(0, 0.1, (HORIZONS, 1))
    samples = np.full((HORIZONS, 1), SAMPLES)
    share = np.full((HORIZONS, 1), 0.2 / (HORIZONS - 1))
    share[0] = 0.8
    squares = HORIZONS * SAMPLES * share * rmse**2
    if lone:
        squares = HORIZONS * SAMPLES * share
        squares[0] -= HORIZONS * SAMPLES * (1 - rmse**2)
    return Score(
        squares,
        samples,
        squares,
        samples,
        np.full((HORIZONS, 1), likelihood) + scatter,
        np.ones(1),
        np.ones(1),
    )


BASE = score(1.0, 0.0)


@pytest.fixture(scope="module")
def trial(make_model):
    """``trial(effect, rmse, likelihood, values, std)`` added to the symmetric model, all else certain."""
    model = make_model()

    def make(effect, rmse=0.5, likelihood=10.0, std=0.01, correlated=None, lone=False, **values):
        candidate = Candidate(effect_named(effect), "carriage")
        richer = candidate.added_to(model)
        port = model.plant.port("carriage")
        found = {p.name: p.guess for p in richer.parameters}
        for p in candidate.effect.parameters:
            found[f"{candidate.name}.{p.name}"] = values.get(p.name, 0.5 * p.scale_at(port))
        free = [p.name for p in richer.free]
        own = [name.startswith(candidate.name) for name in free]
        spread = {n: abs(found[n]) * std if mine else 1e-3 for n, mine in zip(free, own, strict=True)}
        correlation = np.eye(len(free))
        if correlated:
            pair = (own.index(True), free.index(correlated))
            correlation[pair] = correlation[pair[::-1]] = 0.9995
        made = Refit(
            model=richer, values=found, std=spread, correlation=correlation, x0=np.zeros((1, 2)),
            fitted_rmse=np.ones(1), score=score(rmse, likelihood, 1, lone), cost=1.0,
            status="", converged=True, seconds=0.0, substeps=1,
        )  # fmt: skip
        return Trial(candidate, made, compare(BASE, made.score))

    return make


def only(trial):
    (judged,) = judge([trial], RULES)
    return judged


def test_a_refit_that_ended_early_says_so(trial):
    small = trial("asymmetric_viscous", rmse=0.99)
    early = replace(small, refit=replace(small.refit, ended_early=True))
    assert "ended early" in only(early).reason
    assert "ended early" not in only(small).reason


def test_the_seconds_of_a_trial_are_those_of_all_its_refits(trial, monkeypatch):
    """With both integrators, also where the trial of the first is replaced."""
    first = trial("lugre")
    stiff = replace(first, refit=replace(first.refit, too_stiff=True))
    made = iter((stiff, first))

    def solve(*given):
        time.sleep(0.02)
        return next(made)

    monkeypatch.setattr(trials, "_attempt", solve)
    assert trials.attempt(first.candidate, first.refit, SimpleNamespace()).seconds > 0.04


def test_a_large_certain_gain_passes(trial):
    judged = only(trial("asymmetric_viscous"))
    assert judged.status == PASSED
    assert judged.gain == pytest.approx(0.5)


def test_an_amplitude_of_less_than_one_standard_error_is_nothing(trial):
    """Its model is the one without it: whatever it gains held out is no gain of the effect's."""
    assert is_nothing(trial("quadratic_drag", std=2.0))
    assert not is_nothing(trial("quadratic_drag", std=0.5))
    unknown = trial("quadratic_drag", std=2.0)
    assert not is_nothing(replace(unknown, refit=replace(unknown.refit, std={}))), "none was asked for"


def test_a_gain_not_worth_having_is_refused_however_significant(trial):
    judged = only(trial("asymmetric_viscous", rmse=0.97))
    assert judged.comparison.p_value < 1e-10
    assert judged.status == REJECTED
    assert "5 %" in judged.reason


def test_significance_counts_all_that_were_tried(trial):
    """What would pass alone does not among a hundred tries."""
    lucky = trial("asymmetric_viscous", likelihood=LUCKY, lone=True)
    assert 1e-3 < lucky.comparison.p_value < RULES.alpha
    assert only(lucky).status == PASSED
    idle = [trial("stribeck", rmse=1.0, likelihood=-1.0)] * 99
    judged = judge([lucky, *idle], RULES)[0]
    assert judged.status == REJECTED
    assert "not significant" in judged.reason


def test_what_gains_nothing_where_it_is_fitted_costs_the_others_little(trial):
    lucky = trial("asymmetric_viscous", likelihood=LUCKY, lone=True)
    idle = [replace(trial("stribeck", rmse=1.0, likelihood=-1.0), fitted_gain=1e-4)] * 99
    assert judge([lucky, *idle], RULES)[0].status == PASSED
    shy = replace(lucky, fitted_gain=1e-4)
    assert judge([shy, *idle], RULES)[0].status == REJECTED


def test_an_amplitude_that_could_be_nothing_is_not_identifiable(trial):
    judged = only(trial("asymmetric_viscous", std=0.8))
    assert judged.status == UNIDENTIFIABLE
    assert "not determined" in judged.reason


@pytest.mark.parametrize(
    ("effect", "std", "status"),
    [
        ("asymmetric_viscous", 0.49, PASSED),
        ("asymmetric_viscous", 0.51, UNIDENTIFIABLE),
        ("gravity", 0.55, PASSED),
        ("gravity", 0.6, UNIDENTIFIABLE),
    ],
)
def test_two_amplitudes_stand_off_nothing_as_surely_as_one(trial, effect, std, status):
    """Each of gravity's is ``1 / std`` standard errors off, together sqrt(2) times that. Of two the
    chi-squared distribution asks 2.49, where one amplitude needs 2."""
    assert only(trial(effect, std=std)).status == status


def test_the_stiffness_of_a_limit_may_be_large_without_end(trial):
    """Its likelihood is flat towards infinity, so no interval of it excludes zero."""
    assert only(trial("end_stop", std=0.8, d=1e-3)).status == PASSED
    soft = only(trial("cubic_stiffness", std=0.8))
    assert soft.status == UNIDENTIFIABLE


def test_a_shape_at_its_bound_is_a_degenerate_effect(trial):
    stribeck = Candidate(effect_named("stribeck"), "carriage")
    (v_s,) = [p for p in stribeck.effect.parameters if p.name == "v_s"]
    at_bound = v_s.at(EMPS().port("carriage")).upper
    judged = only(trial("stribeck", v_s=at_bound))
    assert judged.status == UNIDENTIFIABLE
    assert "bound" in judged.reason


def test_of_a_shape_that_cannot_be_zero_the_order_of_magnitude_is_enough(trial):
    """A Stribeck velocity with a standard error of 70 % lies between a fourth and four times its value."""
    vague = trial("stribeck")
    spread = {n: 0.7 * vague.refit.values[n] if n.endswith(".v_s") else s for n, s in vague.refit.std.items()}
    assert only(replace(vague, refit=replace(vague.refit, std=spread))).status == PASSED
    lost = {n: 1.2 * vague.refit.values[n] if n.endswith(".v_s") else s for n, s in spread.items()}
    assert only(replace(vague, refit=replace(vague.refit, std=lost))).status == UNIDENTIFIABLE


def test_an_effect_that_another_parameter_mimics_is_not_identifiable(trial):
    judged = only(trial("asymmetric_viscous", correlated="carriage.offset.offset", std=0.1))
    assert judged.status == UNIDENTIFIABLE
    assert "carriage.offset.offset" in judged.reason


def test_what_is_known_to_a_hundredth_is_told_from_what_it_is_collinear_with(trial):
    assert only(trial("asymmetric_viscous", correlated="carriage.offset.offset", std=0.01)).status == PASSED


def test_what_could_not_be_fitted_says_why(make_model):
    candidate = Candidate(effect_named("dahl"), "carriage")
    judged = only(Trial(candidate, None, None, failure="the simulation diverges from every start"))
    assert judged.status == UNTRIED
    assert "diverges" in judged.reason


def test_a_class_holds_what_held_out_horizons_cannot_tell_apart(trial):
    best = trial("asymmetric_viscous", rmse=0.5, likelihood=10.0)
    near = trial("asymmetric_coulomb", rmse=0.505, likelihood=9.9)
    far = trial("quadratic_drag", rmse=0.8, likelihood=3.0)
    judged = judge([best, near, far], RULES)
    names = [t.candidate.effect.id for t in equivalents(judged[0], judged, RULES)]
    assert names == ["asymmetric_viscous", "asymmetric_coulomb"]


def test_a_class_holds_what_is_not_significant_alone_but_not_shown_worse(trial):
    """Its likelihood scatters too much to be shown better than nothing, and so to be shown worse."""
    best = trial("asymmetric_viscous", rmse=0.5, likelihood=10.0, lone=True)
    spread = np.where(np.arange(HORIZONS)[:, None] % 2, 40.0, -38.0)

    def doubtful(effect, rmse, **given):
        made = trial(effect, rmse=rmse, lone=True, **given)
        scored = replace(made.refit, score=replace(made.refit.score, likelihood=spread))
        return replace(made, refit=scored, comparison=compare(BASE, scored.score))

    near, small = doubtful("asymmetric_coulomb", 0.52), doubtful("quadratic_drag", 0.9)
    vague, unknown = doubtful("linear_stiffness", 0.52, std=0.8), doubtful("stribeck", 0.52)
    unknown = replace(unknown, refit=replace(unknown.refit, std={}))  # none was asked for
    judged = judge([best, near, small, vague, unknown], RULES)
    assert [t.status for t in judged] == [PASSED, *4 * [REJECTED]]
    names = [t.candidate.effect.id for t in equivalents(judged[0], judged, RULES)]
    assert names == ["asymmetric_viscous", "asymmetric_coulomb"]


def test_a_look_alike_with_a_parameter_more_is_of_the_class(trial):
    """It leaves half the error, and yet both take nearly all: the simpler is named with it."""
    best = trial("bouc_wen", rmse=0.03, likelihood=20.0)
    simpler = trial("dahl", rmse=0.09, likelihood=12.0)
    stranger = trial("asymmetric_viscous", rmse=0.09, likelihood=12.0)
    judged = [replace(t, status=PASSED) for t in (best, simpler, stranger)]
    names = [t.candidate.effect.id for t in equivalents(judged[0], judged, RULES)]
    assert names == ["bouc_wen", "dahl"]
    judged[1] = replace(trial("dahl", rmse=0.3, likelihood=12.0), status=PASSED)
    assert [t.candidate.effect.id for t in equivalents(judged[0], judged, RULES)] == ["bouc_wen"]


def test_candidates_keep_to_ports_and_to_what_is_missing(make_model):
    model = make_model()
    effects = [effect_named(n) for n in ("viscous", "dahl", "gravity", "input_delay", "sensor_lag")]
    names = [c.name for c in admissible(model, effects)]
    # viscous is there already, gravity wants an angle
    assert names == ["carriage.dahl", "force.input_delay", "position.sensor_lag"]
    assert [c.name for c in admissible(model, effects, ["force"])] == ["force.input_delay"]


def test_candidates_begin_where_the_poorer_model_ended(make_model):
    model = make_model()
    candidate = Candidate(effect_named("stribeck"), "carriage")
    base = {"M": 91.0, "carriage.coulomb.f_c": 19.0}
    starts = candidate.starts(candidate.added_to(model), base)
    assert all(start["M"] == 91.0 for start in starts)
    assert sum(start["carriage.stribeck.df_s"] == 0.0 for start in starts) >= 3
    assert len({start["carriage.stribeck.v_s"] for start in starts}) >= 3
    assert starts[-1]["carriage.stribeck.df_s"] > 0.0
    known = replace(model, adjustments={**model.adjustments, "carriage.stribeck.v_s": {"fixed": 0.02}})
    fixed = candidate.starts(candidate.added_to(known), base)
    assert {start["carriage.stribeck.v_s"] for start in fixed} == {0.02}
    assert 1 < len(fixed) < len(starts)
    guess = {"carriage.stribeck.df_s": {"guess": 3.0}, "carriage.stribeck.v_s": {"guess": 0.033}}
    told = candidate.starts(
        candidate.added_to(replace(model, adjustments={**model.adjustments, **guess})), base
    )
    assert told[: len(starts)] == starts
    assert [(one["carriage.stribeck.df_s"], one["carriage.stribeck.v_s"]) for one in told[len(starts) :]] == [
        (3.0, 0.033),
        (0.0, 0.033),
    ]
    once = Candidate(effect_named("asymmetric_coulomb"), "carriage")  # its guess is zero
    assert once.starts(once.added_to(model), base) == [{**base, "carriage.asymmetric_coulomb.df_c": 0.0}]


@pytest.mark.parametrize(
    ("explicit", "implicit", "kept", "from_starts"),
    [
        ("solved", "solved", "rk4", "none"),
        ("too stiff", "solved", "rodas3", None),
        ("unsolved starts", "solved", "rodas3", (1, 3)),
        ("failed", "solved", "rodas3", None),
        ("too stiff", "no better", "rk4", None),
        ("too stiff", "failed", "rk4", None),
        ("failed", "failed", None, None),
    ],
)
def test_what_is_too_stiff_is_tried_with_the_implicit_integrator(
    monkeypatch, explicit, implicit, kept, from_starts
):
    """A trial must not be refused for the integrator's sake."""
    again = ["none"]

    def tried(candidate, base, split, numerics, to_beat, least, chosen=None):
        if numerics.integrator == "rodas3":
            again[:] = [chosen]
        outcome = {"rk4": explicit, "rodas3": implicit}[numerics.integrator]
        if outcome == "failed":
            return Trial(candidate, None, None, failure=f"not by {numerics.integrator}")
        loss = 1.0 if outcome == "no better" else 0.5 if numerics.integrator == "rodas3" else 1.0
        solved = SimpleNamespace(
            numerics=numerics,
            too_stiff=outcome == "too stiff",
            unsolved=(1, 3) if outcome == "unsolved starts" else (),
            cost=loss,
            score=SimpleNamespace(loss=loss),
        )
        return Trial(candidate, solved, None)

    monkeypatch.setattr(trials, "_attempt", tried)
    candidate = next(admissible(compose(EMPS()), [effect_named("dahl")]))
    found = trials.attempt(candidate, SimpleNamespace(numerics=DECLARED, cost=2.0), None)
    assert again == [from_starts]
    assert (found.refit.numerics.integrator if found.refit else None) == kept
    if kept is None:
        assert found.failure == "not by rk4; with rodas3: not by rodas3"


def test_in_the_place_of_an_effect_a_trial_is_asked_for_a_quarter_of_what_that_takes(monkeypatch, trial):
    asked = []
    monkeypatch.setattr(trials, "_solved", lambda c, base, split, least, rival: asked.append(least) or one)
    one = trial("asymmetric_viscous", 0.5, 1.0)
    base = replace(one.refit, cost=2.0, score=BASE)
    richer = replace(one.refit, cost=0.4, score=score(0.6, 1.0))
    trials.attempt(one.candidate, base, None, RULES.worth, None, richer)
    trials.attempt(one.candidate, base, None, RULES.worth, None, replace(richer, cost=1.99))
    trials.attempt(one.candidate, base, None, RULES.worth)
    assert asked == pytest.approx([0.25 * 0.4, 0.02, 0.02])
