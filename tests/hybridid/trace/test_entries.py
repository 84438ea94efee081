"""What an entry of a trace says of its class."""

from __future__ import annotations

import math
from dataclasses import replace

from hybridid.trace.entries import AcceptedEffect, TriedEffect, Value
from hybridid.trace.remarks import equation_in_words
from hybridid.trace.words import sentence


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
