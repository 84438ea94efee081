"""The verdict's sentence claims no more than the trace's numbers say."""

import math
from dataclasses import replace

import pytest

from hybridid.trace.entries import (
    AcceptedEffect,
    Floor,
    LearnedGain,
    Level,
    ReplacedEffect,
    StepTaken,
    TriedEffect,
    Value,
)
from hybridid.trace.noise_floor.input_noise import NoiseLevel, NoisyInputs
from hybridid.trace.results.result import LearnedGains
from hybridid.trace.search.longer import Longer
from hybridid.trace.search.steps import AT_FLOOR_TOGETHER, RECORDINGS_DIFFER
from hybridid.trace.words.remarks import (
    idle_in_words,
    refused_rivals,
    structure_in_words,
    tried_in_words,
    unsure_in_words,
)
from hybridid.trace.words.words import _members, error_left, sentence


def tried(effect: str, gain: float, reason: str) -> TriedEffect:
    return TriedEffect(effect, "carriage", "rejected", reason, 1, gain, 1.0, {}, math.nan)


DRAG = tried("quadratic_drag", 0.03, "5% less is asked")
SPRING = tried("cubic_stiffness", 0.12, "k_3 is not determined")


@pytest.mark.parametrize(("parameters", "told"), [(1e-6, True), (1e-7, False)])
def test_the_error_of_the_parameters_is_told_where_it_counts(nothing, parameters, told):
    found = replace(nothing(), noise_floor={"position": Floor(2e-6, "m", 1e-6, parameters)})
    said = "error of the parameters that the noise has moved 1 µm"
    assert (said in error_left(found)) is told


def test_nothing_gains(nothing):
    said = sentence(nothing(DRAG))
    assert (
        "the one effect tried does not lower the error on held-out horizons of 1 s (simulated) by 5 %."
        in said
    )
    assert said.endswith(
        "The error left is 3 µm of position (noise of the sensor 2 µm, error of the simulation 1 µm): "
        "1.0 times what noise and simulation alone leave."
    )


def test_a_gain_that_was_refused_is_told(nothing):
    said = sentence(nothing(DRAG, SPRING))
    assert "none of the 2 effects tried" in said
    assert (
        "The largest gain, 12.0 % with cubic_stiffness at carriage, is refused: k_3 is not determined. "
        "No effect that is there could take as much: this one fits noise, or an error of the simulation."
        in said
    )


def test_a_gain_that_a_complete_model_could_take_is_told_without_more(nothing):
    assert "No effect that is there" not in sentence(replace(nothing(SPRING), times=1.2))


def test_longer_horizons_may_show_what_short_ones_do_not(nothing):
    said = sentence(replace(nothing(DRAG), verdict="undecided", longer=Longer(0.3, 7.12)))
    assert said.startswith(
        "These records do not decide whether something is missing: on held-out horizons of 1 s (simulated) "
        "nothing that can be found is, but over horizons of 0.3 s the model leaves 7.1 times what noise and "
        "simulation alone leave. trace.horizon=0.3 may show what is missing. The error left is 3 µm"
    )
    noisy = NoisyInputs({"force": NoiseLevel(3.0, "N")}, {"position": NoiseLevel(1e-6, "m")})
    adds_up = sentence(replace(nothing(DRAG), verdict="undecided", longer=Longer(0.3, 7.12), noisy=noisy))
    assert "Noise of an input adds up over longer horizons, so that alone shows nothing" in adds_up
    assert "trace.horizon" not in adds_up
    fitted = sentence(replace(nothing(DRAG), verdict="undecided", longer=Longer(0.3, 7.12, judged=False)))
    assert "fitted over horizons of 0.3 s the model leaves 7.1 times what" in fitted
    assert "trace.horizon" not in fitted, "too few are held out"


def test_what_judges_may_show_too_little(nothing):
    said = sentence(replace(nothing(DRAG), verdict="undecided", times_fitted=9.4))
    assert said.startswith(
        "These records do not decide whether something is missing: the fitted horizons leave 9.4 times what "
        "noise and simulation alone leave, but the one effect tried does not explain the error on held-out "
        "horizons of 1 s (simulated), which may show too little of the machine. The error left is 3 µm"
    )


def test_nothing_was_tried_because_nothing_is_left(nothing):
    said = sentence(nothing(stopped="the residual meets the noise floor"))
    assert (
        "the residual meets the noise floor on held-out horizons of 1 s (simulated), so no effect was tried."
        in said
    )


def test_effects_that_could_not_be_tried_are_named(nothing):
    said = sentence(nothing(DRAG, replace(SPRING, status="untried")))
    assert said.startswith("The verdict leaves out carriage.cubic_stiffness: no fit could solve it. Nothing")


def test_a_learned_effort_that_could_not_be_solved_is_named(nothing):
    stiff = LearnedGain("carriage", "position", 0.0, 1.0, "N", "m", failure="too stiff")
    said = sentence(replace(nothing(DRAG), ceilings=LearnedGains((), (stiff,))))
    assert said.startswith("The verdict leaves out a learned effort at carriage over position: no fit")


def test_an_error_far_above_the_noise_is_unexplained_also_where_no_place_is_known(nothing):
    said = sentence(replace(nothing(DRAG), verdict="unexplained", times=12.3))
    assert said.startswith("Something is missing that the one effect tried does not explain. The error left")
    assert said.endswith("12.3 times what noise and simulation alone leave.")


def test_a_refused_gain_leaves_the_verdict_open(nothing):
    refused = "12.0% with carriage.cubic_stiffness"
    said = sentence(replace(nothing(SPRING), verdict="undecided", refused=refused))
    assert said.startswith("These records do not decide whether something is missing")
    assert refused in said


def test_a_class_names_each_port_where_these_differ():
    one, other = (
        replace(tried(effect, 0.2, ""), port=port)
        for effect, port in (("input_saturation", "force"), ("load_friction", "carriage"))
    )
    entry = AcceptedEffect(
        "input_saturation", "force", "", "", "", "", {}, {}, ("input_saturation", "load_friction"),
        (one, other), (), 0.0, 0.2, {}, 1.0, 1, (),
    )  # fmt: skip
    assert _members(entry) == "{input_saturation at force, load_friction at carriage}"
    both = (one, replace(other, port="force"))
    assert _members(replace(entry, class_members=both)) == "{input_saturation, load_friction} at force"


def test_of_a_few_that_cannot_be_told_apart_each_is_told_with_its_numbers():
    lag = replace(tried("sensor_lag", 0.2, ""), port="angle", parameters={"T": Value(0.0126, 1e-4, "s")})
    delay = replace(
        tried("input_delay", 0.2, ""), port="torque", parameters={"delay": Value(0.0121, 1e-4, "s")}
    )
    entry = AcceptedEffect(
        "sensor_lag", "angle", "", "", "", "", {"T": Value(0.0128, 2e-4, "s")}, {},
        ("sensor_lag", "input_delay"), (lag, delay), (), 0.0, 0.2, {}, 1.0, 1, (),
    )  # fmt: skip
    said = (
        "sensor_lag at angle (T = 0.01280 ± 0.00039 s), input_delay at torque (delay = 0.01210 ± 0.00020 s)"
    )
    assert _members(entry) == f"{{{said}}}"
    assert (
        _members(replace(entry, class_members=(lag, delay) * 2))
        == "{sensor_lag at angle, input_delay at torque}"
    )


def test_what_is_learned_at_a_level_is_a_flow(nothing):
    level = LearnedGain("upper", "level", 0.2, 1e-6, "V/s", "V", kind="flow")
    velocity = LearnedGain("valve", "velocity", 0.0, 1.0, "N", "m/s")
    flows, both = (LearnedGains((), after) for after in ((level,), (level, velocity)))
    said = structure_in_words(replace(nothing(DRAG), ceilings=flows, remains=("at upper over level",)))
    assert said.startswith("Structure remains at upper over level: a learned flow there still lowers")
    said = structure_in_words(replace(nothing(DRAG), ceilings=both))
    assert said.startswith("A learned effort or flow still lowers the held-out error by 5 % or more")
    stiff = replace(level, failure="too stiff")
    said = sentence(replace(nothing(DRAG), ceilings=LearnedGains((), (stiff,))))
    assert said.startswith("The verdict leaves out a learned flow at upper over level: no fit")


def accepted(effect, equation, is_law, alike=(), form_of=""):
    members = tuple(replace(tried(name, 0.5, ""), is_law=is_law) for name in (effect, *alike))
    return AcceptedEffect(
        effect=effect, port="carriage", title="", equation=equation, pattern="", source="",
        parameters={"k": Value(-36.9, 2.25, "N·s/m")}, known={}, alike=(effect, *alike),
        class_members=members,
        separating_experiments=(), p_value=1e-6, gain=0.4, at_step={}, likelihood_gain=1.0, step=1,
        survivals=(), is_law=is_law, form_of=form_of,
    )  # fmt: skip


def test_a_proposed_law_is_told_as_a_formula_and_no_name(nothing):
    law = accepted("modulus_of_velocity", "F = k |v|", True, ("square_of_velocity",), "asymmetric_viscous")
    refused = replace(tried("cube_of_velocity", 0.1, "less"), is_law=True, status="untried")
    path = (nothing().path[0], Level("", {"position": 1.5e-6}, {}, 0.5))
    found = replace(nothing(DRAG, refused), verdict="law_proposed", accepted=(law,), path=path)
    assert sentence(found) == (
        "Something is missing that the one effect tried does not explain. The law proposed at carriage is "
        "F = k |v| (k = −36.9 ± 4.4 N·s/m), which is the form of asymmetric_viscous; these records cannot "
        "tell it from square_of_velocity: with it the RMSE on held-out horizons of 1 s (simulated) falls "
        "from 3 µm to 1.5 µm (50 % less) in position."
    )
    assert tried_in_words(found) == "1 effect and 2 laws"
    structured = replace(found, remains=("at carriage over velocity",), times=1.85)
    assert sentence(structured).endswith(
        " Structure may remain at carriage over velocity. But only 1.9 times the error of noise and "
        "simulation is left, and the noise of a logged input alone can do that."
    )
    far = sentence(replace(structured, times=9.0))
    assert "Structure remains at carriage over velocity that no effect in the library explains. More" in far


def test_an_effect_with_the_form_of_the_law_that_was_withdrawn_is_told(nothing):
    """Moving one way, v² and v |v| are one."""
    alike = ("signed_square_of_velocity", *(f"law_{k}" for k in range(6)))
    law = accepted("square_of_velocity", "F = k v²", True, alike)
    drag = replace(DRAG, reason="may stand in for something else: these records cannot tell it from a spring")
    path = (nothing().path[0], Level("", {"position": 1.5e-6}, {}, 0.5))
    said = sentence(replace(nothing(drag), verdict="law_proposed", accepted=(law,), path=path))
    assert "cannot tell it from signed_square_of_velocity (the form of quadratic_drag), law_0, law_1" in said
    assert "law_3 and 2 others: with it" in said
    assert "passed first" not in said
    assert said.startswith(
        "Something is missing. carriage.quadratic_drag passed, but is no sure name: these records cannot "
        "tell it from a spring. The law proposed at carriage is F = k v²"
    )


def test_names_are_told_before_a_law(nothing):
    law, name = accepted("cube_of_velocity", "F = k v³", True), accepted("stribeck", "F = k", False)
    path = (nothing().path[0], Level("", {"position": 1.5e-6}, {}, 0.5))
    said = sentence(replace(nothing(DRAG), verdict="law_proposed", accepted=(law, name), path=path))
    assert said.startswith("The model lacked stribeck at carriage (k = −36.9 ± 4.4 N·s/m). Something else is")
    assert "The law proposed at carriage is F = k v³ (k = −36.9 ± 4.4 N·s/m): with them the RMSE" in said
    found = replace(nothing(DRAG), verdict="law_proposed", accepted=(law,), path=path, in_place_of=("a", "b"))
    assert ". a and b passed first; the law alone explains more, or as much with fewer" in sentence(found)


def test_a_name_in_doubt_that_is_no_class_may_have_been_lacked(nothing):
    path = (nothing().path[0], Level("", {"position": 1.5e-6}, {}, 0.5))
    found = replace(nothing(), accepted=(accepted("stribeck", "F = k", False),), path=path)
    assert sentence(replace(found, verdict="ambiguous")).startswith("The model may have lacked stribeck at")
    assert sentence(replace(found, verdict="effect_found")).startswith(
        "The model lacked stribeck at carriage"
    )


@pytest.mark.parametrize(("times", "said"), [(75.64, "75.6 times"), (14998.0, "more than a thousand times")])
def test_a_name_far_above_the_noise_may_stand_for_a_part(nothing, times, said):
    path = (nothing().path[0], Level("", {"position": 1.5e-6}, {}, 0.5))
    name = accepted("stribeck", "F = k", False)
    found = replace(nothing(), verdict="effect_found", accepted=(name,), path=path, times=times)
    assert sentence(found).endswith(
        f" More is missing: the error left is {said} what noise and simulation alone leave. "
        "A name may stand for a part of that."
    )
    assert "More is missing" not in sentence(replace(found, times=2.9))
    fitted = sentence(replace(found, times=2.9, times_fitted=3.4))
    assert (
        " More may be missing: the fitted horizons leave 3.4 times what noise and simulation alone" in fitted
    )
    smooth = LearnedGain("carriage", "velocity", 0.04, 1e-3, "N", "m/s")
    said_of_rest = sentence(replace(found, ceilings=LearnedGains((), (smooth,))))
    assert "But no learned effort takes 5 % of it, and a disturbance" in said_of_rest
    found_more = replace(found, ceilings=LearnedGains((), (replace(smooth, gain=0.06),)))
    assert sentence(found_more) == sentence(found)
    together = sentence(replace(found, stopped=AT_FLOOR_TOGETHER))
    assert "More is missing" not in together
    assert "its parameters are uncertain" in together


def test_a_parameter_without_a_standard_error_is_explained(nothing):
    name = accepted("input_saturation", "F = k", False)
    bound = replace(name, parameters={"n": Value(100.0, math.nan, "")})
    assert unsure_in_words(replace(nothing(), accepted=(name, bound))).startswith("± ?: no standard error.")
    assert unsure_in_words(replace(nothing(), accepted=(name,))) == ""


def test_a_rival_that_was_refused_for_its_amplitude_is_told(nothing):
    why = "its amplitude is no constant: k = 4 ± 1 N in the fitted records, 2 ± 1 N in those held out"
    name, rival = accepted("stribeck", "F = k", False), tried("cogging", 0.3, why)
    step = StepTaken(nothing().path[0], name.name, (), (DRAG, rival))
    found = replace(nothing(), accepted=(name,), steps=(step,))
    said = f"carriage.cogging is not shown to explain less than carriage.stribeck, but {why}."
    assert refused_rivals(found) == (said,)
    assert refused_rivals(replace(found, accepted=())) == ()
    assert refused_rivals(replace(found, steps=(replace(step, together="carriage.offset"),))) == ()


def test_a_pair_helps_only_together(nothing):
    spring, offset, drag = (accepted(name, "F", False) for name in ("spring", "offset", "drag"))
    spring, offset = replace(spring, together=offset.name), replace(offset, together=spring.name)
    path = (nothing().path[0], Level("", {"position": 1.5e-6}, {}, 0.5))
    step = StepTaken(nothing().path[0], spring.name, (), (DRAG, SPRING), together=offset.name)
    found = replace(
        nothing(), verdict="effect_found", accepted=(drag, spring, offset), path=path, steps=(step,)
    )
    assert sentence(found).endswith(
        "in position. carriage.spring and carriage.offset help only together: neither passed alone."
    )
    assert "together" not in sentence(replace(found, accepted=(drag, spring)))
    alone = replace(tried("spring", 0.2, ""), status="passed")
    said = sentence(replace(found, steps=(replace(step, trials=(alone,)),)))
    assert said.endswith(
        "carriage.spring and carriage.offset were found together: they explain more than what passed alone."
    )


def test_what_speaks_against_the_declared_physics_is_told(nothing):
    pair = ("carriage.coulomb", "carriage.quadratic_drag")
    better = ReplacedEffect("carriage.viscous", pair, "better", 0.28, 2e-5, -1, {}, {})
    assert better.names == ("coulomb@carriage", "quadratic_drag@carriage")
    found = replace(nothing(DRAG), replacements=(better,), idle=("carriage.offset",))
    assert sentence(found).endswith(
        " The declared carriage.viscous may be wrong: carriage.coulomb and carriage.quadratic_drag in its "
        "place leave 28.0 % less error (p = 2.00·10⁻⁵)."
    )
    same = replace(better, left_out="carriage.offset", effects=better.effects[::-1], gain=0.27)
    worse = replace(better, left_out="carriage.dahl", gain=0.2)
    said = sentence(replace(found, replacements=(better, same, worse)))
    assert " The declared carriage.viscous or carriage.offset may be wrong: " in said
    assert idle_in_words(found) == (
        "Over these horizons, the records do not tell carriage.offset, which was declared, from zero."
    )
    assert idle_in_words(replace(found, times=5.0)).startswith("Beside what is missing, the records do not")
    assert idle_in_words(nothing()) == ""


def test_a_replacement_that_is_only_as_good_is_told_as_such(nothing):
    pair = ("carriage.coulomb", "carriage.quadratic_drag")
    as_good = ReplacedEffect("carriage.viscous", pair, "as_good", 0.001, 0.4, 3, {}, {})
    found = replace(
        nothing(),
        verdict="effect_found",
        accepted=(accepted("coulomb", "F = k", False), accepted("eddy_brake", "F = k", False)),
        path=(nothing().path[0], Level("", {"position": 1.5e-6}, {}, 0.5)),
        replacements=(as_good,),
    )
    assert sentence(found).endswith(
        " The declared carriage.viscous may be wrong: carriage.coulomb and carriage.quadratic_drag in its "
        "place explain the records as well with 3 parameters fewer, without carriage.eddy_brake. These "
        "records cannot tell the two models apart; the simpler one is preferred."
    )
    alone = replace(as_good, effects=pair[:1], fewer=1)
    said = sentence(replace(nothing(), replacements=(alone,)))
    assert " explains the records as well with 1 parameter fewer. These" in said


def test_a_search_that_ended_early_says_so_though_nothing_else_tells_of_the_recordings(nothing):
    said = sentence(replace(nothing(DRAG), stopped=RECORDINGS_DIFFER))
    assert f"The search ended early: {RECORDINGS_DIFFER}. trace.by_recording=false searches on." in said
    assert "ended early" not in sentence(nothing(DRAG))
