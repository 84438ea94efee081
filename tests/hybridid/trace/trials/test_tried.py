"""The trials of a step: which come first, and what is told of them as they end."""

from __future__ import annotations

from types import SimpleNamespace

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.trials.tried import MostSoFar, trials_of


def ended(name, gain):
    return SimpleNamespace(candidate=SimpleNamespace(name=name), gain=gain)


def test_what_takes_most_so_far_is_told_with_each_result():
    label = MostSoFar()
    told = [label(ended(*one)) for one in (("a.offset", 0.004), ("a.dahl", 0.08), ("a.drag", 0.05))]
    assert told == [
        "a.offset",
        "a.dahl, most so far a.dahl: 8.0% off the held-out error",
        "a.drag, most so far a.dahl: 8.0% off the held-out error",
    ]


def test_quick_trials_come_first(make_model, split_of):
    told: list[str] = []

    def report(stage, done, of, what):
        if stage == "step 1" and what:
            told.append(what.split(",")[0])

    split = split_of(df_v=75.0)
    tried = tuple(map(effect_named, ("dahl", "offset", "quadratic_drag")))
    context = Context(split, tried, report=report)
    base = refit(make_model(("viscous", "coulomb")), split)
    trials, left_out = trials_of(base, context, "step 1")
    assert told == ["carriage.offset", "carriage.quadratic_drag", "carriage.dahl"]
    assert [one.candidate.name for one in trials] == ["carriage.dahl", *told[:2]], "in the library's order"
    assert left_out == ()
