"""What is told of refused gains: the best supported one, and a larger one that few horizons cannot show."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.trace.entries import StepTaken, TriedEffect, TriedPair, Value
from hybridid.trace.words.refused_words import refused_for_significance, why_passed_over
from hybridid.trace.words.remarks import tried_in_words
from hybridid.trace.words.words import sentence


def tried(effect: str, gain: float, reason: str) -> TriedEffect:
    return TriedEffect(effect, "carriage", "rejected", reason, 1, gain, 1.0, {}, math.nan)


DRAG = tried("quadratic_drag", 0.03, "5% less is asked")
SPRING = tried("cubic_stiffness", 0.12, "k_3 is not determined")


def test_pairs_that_were_tried_are_told(nothing):
    names = ("carriage.spring", "carriage.offset")
    pair = TriedPair(names, "rejected", "adjusted p = 0.1 over 0.01", 0.1, 0.1, (), 0.3, {}, 1.0)
    step = StepTaken(nothing().path[0], None, (), (), pairs=(pair, pair), family=741)
    found = replace(nothing(DRAG, SPRING), verdict="unexplained", times=12.3, steps=(step,))
    assert sentence(found).startswith(
        "Something is missing that none of the 2 effects tried is shown to explain, alone or in 2 pairs. The "
        "best supported of the refused gains is 10.0 % with carriage.spring and carriage.offset: adjusted "
        "p = 0.1 over 0.01. The "
    )
    likelier = replace(tried("coulomb", 0.07, "adjusted p = 0.02 over 0.01"), p_value=0.02)
    said = sentence(replace(found, steps=(replace(step, trials=(likelier,)),)))
    assert "gains is 7.0 % with carriage.coulomb: adjusted p = 0.02 over 0.01." in said
    strong = replace(pair, gain=0.58, p_value=1.0, reason="adjusted p = 1 over 0.01")
    steps = (replace(step, trials=(likelier,), pairs=(strong,)), replace(step, pairs=()))
    assert (
        "is 7.0 % with carriage.coulomb: adjusted p = 0.02 over 0.01. The largest is 58.0 % with "
        "carriage.spring and carriage.offset: adjusted p = 1 over 0.01. The error"
    ) in sentence(replace(found, steps=steps)), "laws were tried after the pairs"
    alone = sentence(replace(found, steps=(replace(step, pairs=(strong, replace(strong, gain=0.2))),)))
    assert (
        "Chance alone explains each of the refused gains. The largest is 58.0 % with carriage.spring and "
        "carriage.offset: adjusted p = 1"
    ) in alone, "nothing supports it"
    at_noise = replace(found, times=1.1)
    assert "refused" not in sentence(at_noise), "no complete model could take 10 %"
    assert tried_in_words(found) == "2 effects and 2 of 741 pairs of them"


def test_what_had_passed_and_was_withdrawn_is_told(nothing):
    why = "carriage.coulomb may stand in for something else: its amplitude is another one there"
    said = sentence(replace(nothing(DRAG), verdict="unexplained", withdrawn=why, times=9.0))
    assert said.startswith(
        f"Something is missing that the one effect tried does not explain. {why}. The error left is 3 µm"
    )
    same = replace(tried("coulomb", 0.3, why.removeprefix("carriage.coulomb ")), p_value=1e-6)
    step = StepTaken(nothing().path[0], None, (), (same,))
    again = replace(nothing(DRAG), verdict="unexplained", withdrawn=why, times=9.0, steps=(step,))
    assert "refused gains is 30.0 % with carriage.coulomb. The error" in sentence(again), "told once"


def test_what_the_records_do_not_determine_is_no_hint(nothing):
    """A sine of any period fits few horizons; the drag, which takes less, is known."""
    lacking = "not significant: adjusted p = 0.05 over 0.01"
    sine = replace(
        tried("periodic_error", 0.3, lacking), p_value=0.05, parameters={"period": Value(512.0, 1085.0, "m")}
    )
    drag = replace(
        tried("quadratic_drag", 0.2, lacking), p_value=0.05, parameters={"c_d": Value(7.0, 0.6, "N·s²/m²")}
    )
    step = StepTaken(nothing().path[0], None, (), (sine, drag))
    found = replace(nothing(DRAG), verdict="unexplained", times=9.0, steps=(step,))
    assert "gains is 20.0 % with carriage.quadratic_drag: not significant" in sentence(found)
    assert "periodic_error" not in sentence(found)
    assert refused_for_significance(found)
    assert not refused_for_significance(replace(found, steps=(replace(step, trials=(sine,)),)))


@pytest.mark.parametrize(
    ("gain", "taken", "said"),
    [
        (0.3, ["a.viscous"], "but less than a.viscous, accepted in its step"),
        (0.6, ["a.viscous"], "but it is not shown to explain more than a.viscous, accepted in its step"),
        (0.3, ["a.dahl", "a.cogging"], "but less than a.dahl and a.cogging, accepted in its step"),
        (0.3, [], "but less than what was accepted in its step, which was withdrawn later"),
    ],
)
def test_what_passed_and_was_not_accepted_says_what_was(gain, taken, said):
    accepted = [SimpleNamespace(name=name, trial=SimpleNamespace(gain=0.5)) for name in taken]
    assert why_passed_over(SimpleNamespace(gain=gain), accepted) == said
