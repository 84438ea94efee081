"""A pair is refused where another one, physically unrelated, explains as much."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.evidence import Comparison
from hybridid.trace.rules import Rules
from hybridid.trace.search import pair_decision
from hybridid.trace.trials.pair import PairTrial
from hybridid.trace.trials.trial import PASSED, Trial


@pytest.fixture
def made(monkeypatch):
    """``made("offset", "linear_stiffness")``: a pair that passes, as good as any other."""
    monkeypatch.setattr(pair_decision, "_as_good", lambda best, other, rules: True)

    def make(*names):
        candidates = tuple(Candidate(effect_named(name), "carriage") for name in names)
        solved = SimpleNamespace(score=SimpleNamespace(loss=0.1))
        members = tuple(Trial(one, solved, Comparison(0.9, 1e-9, 1.0)) for one in candidates)
        return PairTrial(candidates, 0.5, solved, Comparison(0.9, 1e-9, 1.0), members, status=PASSED)

    return make


@pytest.mark.parametrize(
    ("other", "refused"),
    [
        (("offset", "quadratic_drag"), False),  # a common member: the other one's rivals are tried
        (("cubic_stiffness", "asymmetric_coulomb"), False),  # a look-alike of each
        (("asymmetric_coulomb", "cubic_stiffness"), False),
        (("quadratic_drag", "stribeck"), True),
        (("cubic_stiffness", "stribeck"), True),
    ],
)
def test_a_pair_is_refused_where_strangers_explain_as_much(made, other, refused):
    best, equal = made("offset", "linear_stiffness"), made(*other)
    step = SimpleNamespace(base=SimpleNamespace(score=SimpleNamespace(loss=1.0)))
    why = pair_decision._strangers(step, best, [best, equal], Rules())
    assert bool(why) == refused
    assert not refused or why == f"these records cannot tell it from {equal.name}, physically unrelated to it"
    assert (
        pair_decision._strangers(step, best, [best, replace(equal, status="unidentifiable")], Rules()) == ""
    )
