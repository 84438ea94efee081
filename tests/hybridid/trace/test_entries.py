"""What an entry of a trace says of its class."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from hybridid.trace.entries import AcceptedEffect, StepTaken, TriedEffect, Value
from hybridid.trace.rules import Rules
from hybridid.trace.words.remarks import equation_in_words, richer_laws, told_apart
from hybridid.trace.words.words import sentence


def member(effect: str, port: str) -> TriedEffect:
    return TriedEffect(effect, port, "passed", "", 1, 0.5, 1e-6, {}, math.nan)


def accepted(*members: TriedEffect) -> AcceptedEffect:
    ids = tuple(dict.fromkeys(one.effect for one in members))
    return AcceptedEffect(
        effect=members[0].effect, port=members[0].port, title="", equation="", pattern="", source="",
        parameters={}, known={}, alike=ids, class_members=members, separating_experiments=(), p_value=1e-6,
        gain=0.5, at_step={}, likelihood_gain=1.0, step=1, survivals=(), is_law=False, form_of="",
    )  # fmt: skip


SCALES = accepted(member("sensor_scale", "link"), member("sensor_scale", "motor"))


def test_the_same_effect_at_another_port_is_told_with_its_port():
    assert SCALES.others == ("sensor_scale at motor",)
    assert accepted(member("dahl", "joint"), member("coulomb", "joint")).others == ("coulomb",)


def test_the_sentence_names_both_ports(nothing):
    found = nothing()
    path = (*found.path, *found.path)
    said = sentence(replace(found, verdict="ambiguous", accepted=(SCALES,), path=path))
    assert (
        "one of {sensor_scale at link, sensor_scale at motor} (these records cannot tell them apart)" in said
    )


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (-0.001, "these records cannot tell them apart"),
        (0.019, "these records cannot tell them apart"),
        (0.06, "not significantly worse: joint.coulomb leaves 6.0 % more error"),
        (1.04, "not excluded: joint.coulomb leaves 104.0 % more error"),
    ],
)
def test_a_member_that_leaves_more_error_is_told_with_how_much(more, told):
    poorer = replace(member("coulomb", "joint"), more=more)
    said = told_apart(accepted(member("dahl", "joint"), poorer), Rules())
    assert said.replace("\N{NO-BREAK SPACE}", " ") == told


def test_an_equation_is_told_with_the_constants_that_are_not_estimated():
    entry = replace(SCALES, equation="F = k r √(r/h)")
    assert equation_in_words(entry) == "F = k r √(r/h)"
    known = {"h": Value(0.3, math.nan, "m"), "side": Value(-1.0, math.nan, "1")}
    assert equation_in_words(replace(entry, known=known)) == "F = k r √(r/h), with h = 300 mm and side = −1"


def test_what_the_records_hardly_show_is_no_name(nothing):
    ours, other = accepted(member("dahl", "joint")), accepted(member("viscous", "joint"))
    found = replace(nothing(), verdict="effect_found", accepted=(ours, replace(other, shown=False)))
    said = sentence(found)
    assert said.startswith("The model lacked dahl at joint (")
    assert ": with it, and with joint.viscous, which these records hardly show (it is no name: its " in said
    several = replace(found, accepted=(ours, *(replace(other, shown=False),) * 2))
    assert "hardly show (they are no names: their intervals include zero), the RMSE" in sentence(several)


def test_a_richer_law_that_the_records_do_not_determine_is_told(nothing):
    """LuGre's friction contains Dahl's, and so does Bouc-Wen's hysteresis."""
    known = {"f_c": Value(1.0, 0.1, "N"), "s": Value(0.1, 0.01, "m")}
    dahl = replace(member("dahl", "cart"), parameters=known)
    vague = "sigma_1 = 3 ± 9 N·s/m: not determined by these records"
    rich = {**known, "sigma_1": Value(3.0, 9.0, "N·s/m")}
    lugre = replace(member("lugre", "cart"), status="unidentifiable", reason=vague, parameters=rich)
    found = replace(nothing(), accepted=(accepted(dahl),))

    def told(*trials: TriedEffect) -> tuple[str, ...]:
        return richer_laws(replace(found, steps=(StepTaken(nothing().path[0], None, (), trials),)))

    assert told(dahl, lugre) == (
        f"cart.lugre contains the law of dahl and explains as much ({vague}). These records do not "
        "exclude it.",
    )
    assert told(dahl, replace(lugre, gain=0.3)) == (), "it explains less"
    assert told(dahl, replace(lugre, parameters=known)) == (), "it is no richer"
    assert told(dahl, replace(lugre, port="motor")) == ()
    assert told(dahl, replace(lugre, status="rejected")) == (), "its parameters are determined"
