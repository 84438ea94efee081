"""What overflows one tank and enters another in part: out of the first level, its share into the second."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.drawn.oracle import split_of as judged
from benchmarks.rebuilt import machines
from benchmarks.rebuilt.draw import Draw, all_draws
from benchmarks.rebuilt.tanks import WEIR, Tanks
from hybridid.effects.dimension import EFFORT
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.trace.candidates import Candidate, admissible
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import refit
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.judgement import undetermined
from hybridid.trace.trials.trial import Trial, attempt

INTO = "upper+lower.overflow_into"


def rates(values: dict[str, float], upper: float) -> np.ndarray:
    """Rates of the lower and the upper level, less those without the overflow."""
    bare, model = compose(Tanks()), compose(Tanks(), ["overflow_into@upper+lower"])
    x, u = [2.0, upper], [1.0]
    with_it = np.asarray(model.f(0.0, x, u, model.values(values))).ravel()
    return with_it - np.asarray(bare.f(0.0, x, u, bare.values({}))).ravel()


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_what_leaves_the_first_level_enters_the_second_by_its_share(share):
    values = {f"{INTO}.k": 0.3, f"{INTO}.limit": 4.0, f"{INTO}.share": share}
    lower, upper = rates(values, 6.0)
    assert upper == pytest.approx(-0.3 * 2.0 * np.sqrt(2.0 / 5.0), rel=1e-3)
    assert lower == pytest.approx(-share * upper)
    assert rates(values, 3.0) == pytest.approx(0.0, abs=1e-6)


def test_it_is_tried_from_each_level_into_each_other(tank):
    tried = {one.port for one in admissible(compose(Tanks()), [effect_named("overflow_into")])}
    assert tried == {"upper+lower", "lower+upper"}
    assert not list(admissible(compose(tank), [effect_named("overflow_into")]))


@pytest.mark.parametrize("port", ["upper", None])
def test_one_level_alone_is_refused(port):
    with pytest.raises(ValueError, match=r"name both, as overflow_into@FIRST\+SECOND"):
        compose(Tanks()).plus(effect_named("overflow_into"), port)


@pytest.mark.parametrize(("kind", "into"), [("effort", "k"), ("flow", "part")])
def test_only_a_flow_leads_into_another_level_by_a_parameter_of_its_own(kind, into):
    k = EffectParameter("k", EFFORT, "amount", nests=True)
    with pytest.raises(ValueError, match="into is"):
        Effect("own", kind, "own", "F = k", lambda at: at.p.k, "source", "pattern", (k,), into=into)


DRAW = next(d for d in all_draws(8) if d.row == "overflow" and d.category == "missing")


def overflowing(draw: Draw) -> tuple[Refit, Split, Trial]:
    """Of simulated tanks the declared model, its split, and the trial of an overflow into the lower one. The
    lower level alone is recorded."""
    case = machines.declared(draw)
    split = judged(case, machines.records_of(draw))
    base = refit(case.model(), split, [case.truth])
    return base, split, attempt(Candidate(effect_named("overflow_into"), "upper+lower"), base, split)


def test_what_enters_the_lower_tank_is_told_from_what_is_lost():
    base, split, into = overflowing(DRAW)
    lost = attempt(Candidate(effect_named("overflow"), "upper"), base, split)
    assert into.gain > 0.5 > lost.gain
    own = into.own("values")
    assert own["share"] == pytest.approx(DRAW.amounts["share"], abs=0.03)
    assert own["k"] * own["h"] ** -0.5 == pytest.approx(WEIR, rel=0.3)
    assert not undetermined(into, Rules())


def test_where_all_is_lost_nothing_is_said_to_enter_the_lower_tank():
    _, _, into = overflowing(replace(DRAW, amounts={**DRAW.amounts, "share": 0.0}))
    assert into.gain > 0.5
    assert undetermined(into, Rules()).endswith("nothing is shown to enter the second level")
