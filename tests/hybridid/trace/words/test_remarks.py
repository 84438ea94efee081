"""What is remarked beside the verdict: what a network still finds, rivals, declared physics, smoothings."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.trace.entries import EstimatedValue, LearnedGain, StepTaken, TriedEffect, Width
from hybridid.trace.results.completeness import Completeness
from hybridid.trace.results.result import Estimates, LearnedGains
from hybridid.trace.words.remarks import (
    completeness_in_words,
    idle_in_words,
    mostly_unshown,
    narrowed_in_words,
    others_in_words,
    rivals,
)


@pytest.mark.parametrize(
    ("gain", "p_value", "complete", "said"),
    [
        (
            0.431,
            0.017,
            True,
            "At the level of 1 % that is not shown to be more than chance, which does not say that nothing "
            "is missing",
        ),
        (
            0.041,
            0.0005,
            True,
            "That is less than 5 %: it finds nothing more worth having",
        ),
        (-0.02, 1.0, True, "takes nothing from the held-out error. So it finds nothing more worth having"),
        (0.431, 0.0005, False, "That gain does not survive other ways of solving the equations"),
    ],
)
def test_a_gain_that_is_not_significant_is_no_proof_that_nothing_is_missing(
    nothing, gain, p_value, complete, said
):
    network = Completeness("12 bumps over v at cart", gain, p_value, complete, gain, "")
    assert completeness_in_words(replace(nothing(), completeness=network)).endswith(said)


def test_the_parameters_of_a_last_model_that_is_not_the_declared_one_are_told(nothing):
    mass = EstimatedValue(93.2, 0.5, "kg", (92.2, 94.2), False, True, "moving mass")
    found = replace(nothing(), estimates=Estimates({}, {"M": mass}))
    assert others_in_words(found) == ""
    narrower = replace(found, narrowed=(Width("cart.epsilon", "m/s", 1e-3, 1e-4),))
    assert others_in_words(narrower) == "parameters of the last model: M = 93.20 ± 0.98 kg"
    wrong = replace(narrower, times=9.0)
    assert others_in_words(wrong).endswith("kg (the errors ± do not count what is missing)")


def test_where_all_is_unexplained_no_declared_effect_is_called_zero(nothing):
    found = replace(nothing(), idle=("cart.viscous",))
    assert idle_in_words(found).startswith("Over these horizons, the records do not tell cart.viscous")
    assert idle_in_words(replace(found, verdict="unexplained", times=9.0)) == ""
    assert idle_in_words(replace(found, idle=(), either=("cart.viscous", "cart.offset"))) == (
        "Over these horizons, each of cart.viscous and cart.offset, which were declared, may be zero, but "
        "not all of them: what they do together is shown, which of them does it is not."
    )


def test_a_refused_gain_is_told_where_the_network_finds_nothing_more(nothing):
    """What a network over one variable cannot find, an effect with a state may."""
    bound = "g = 93 nm ends at its bound: the effect degenerates"
    play = TriedEffect("backlash", "spring", "unidentifiable", bound, 1, 0.463, 1e-16, {}, 1.0)
    network = Completeness("12 bumps over v at cart", 0.02, 0.3, True, 0.5, "")
    step = StepTaken(nothing().path[0], None, (), (play,))
    said = completeness_in_words(replace(nothing(), completeness=network, steps=(step,), times=2.93))
    assert said.endswith(
        f"That is less than 5 %. But the largest of the refused gains is 46.3 % with spring.backlash: {bound}"
    )
    chance = replace(step, trials=(replace(play, p_value=0.4),))
    said = completeness_in_words(replace(nothing(), completeness=network, steps=(chance,), times=2.93))
    assert said.endswith("it finds nothing more worth having")


@pytest.mark.parametrize(
    ("gain", "times", "said"),
    [
        (
            0.08,
            15.0,
            " The strongest learned effort (at cart over position) takes 8.0 % of it: most of what ",
        ),
        (-0.2, 15.0, " No learned effort helps: most of what is left is no function of a single variable "),
        (0.3, 15.0, ""),
        (0.08, 2.9, ""),
    ],
)
def test_what_most_learned_efforts_miss_may_be_a_disturbance(nothing, gain, times, said):
    """A gain of 30 % of the RMSE is half of the squared error."""
    one = LearnedGain("cart", "position", gain, 1e-8, "N", "m")
    found = replace(nothing(), ceilings=LearnedGains((), (one,)), times=times)
    told = mostly_unshown(found)
    assert told.startswith(said) if said else told == ""
    assert "In a closed loop" not in told
    looks = mostly_unshown(replace(found, remains=("at cart over position",)))
    assert looks.endswith("may look like structure.") is bool(said)


def test_where_a_time_limit_left_learned_efforts_out_none_is_the_strongest(nothing):
    one = LearnedGain("cart", "position", 0.08, 1e-8, "N", "m")
    left_out = replace(one, over="position, times velocity", gain=0.0, ended_early=True, fitted=False)
    found = replace(nothing(), ceilings=LearnedGains((), (one, left_out)), times=15.0)
    assert mostly_unshown(found) == ""


def test_a_rival_whose_parameters_the_records_do_not_tell_is_told(nothing):
    """One that explains as much as what was accepted, and not one that explains less."""
    why = "f_c = 0.7 ± 8.2 N: not determined by these records"
    best = TriedEffect("eddy_brake", "drum", "passed", "", 1, 0.37, 1e-9, {}, 1.0)
    lugre = replace(best, effect="lugre", status="unidentifiable", reason=why, gain=0.39)
    name = SimpleNamespace(name=best.name, step=1, together="", class_members=(best,))
    step = StepTaken(nothing().path[0], best.name, (), (best, lugre, replace(lugre, effect="dahl", gain=0.1)))
    said = f"drum.lugre explains as much as drum.eddy_brake (39.0 %), but {why}."
    assert rivals(replace(nothing(), accepted=(name,), steps=(step,))) == (said,)


def test_a_narrower_smoothing_is_told(nothing):
    found = replace(nothing(), narrowed=(Width("carriage.epsilon", "m/s", 1e-3, 2.5e-4),))
    said = "sign(v) is smoothed over 250 µm/s instead of 1 mm/s (carriage.epsilon): the wider smoothing left "
    assert narrowed_in_words(found) == f"{said}an error of its own."
    named = narrowed_in_words(replace(found, accepted=(SimpleNamespace(name="carriage.stribeck"),)))
    assert named.endswith(" is that of its step, which may have had the wider one.")
    assert narrowed_in_words(nothing()) == ""
