"""The study of declarations: its draws are fixed, it declares what it states, its scores add up. All is
simulated."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.answers import digest
from benchmarks.declarations import machines
from benchmarks.declarations.__main__ import main
from benchmarks.declarations.draw import CATEGORIES, SHARES, STIFFNESS, WRONG, all_draws, drawn
from benchmarks.declarations.play import LEAGUE, consult, traced
from benchmarks.declarations.scoring import Replaced, Round, asked, wrong_and_truths

DRAWS = all_draws()
SPRING = drawn(1000, "spring", "flexible_link")
"""A scenario that the study does not play."""
VISCOUS, PAIR = "carriage.viscous", [("carriage.coulomb",), ("carriage.quadratic_drag",)]


def test_draws_are_fixed_and_as_stated():
    assert Counter(d.category for d in DRAWS) == dict.fromkeys(CATEGORIES, 10)
    assert len({d.key for d in DRAWS}) == len({digest(d, "") for d in DRAWS}) == len(DRAWS)
    assert [drawn(d.number, d.category, d.machine) for d in DRAWS[::7]] == list(DRAWS[::7])
    for d in DRAWS:
        bounds = SHARES[d.category]
        assert all(bounds[name][0] <= share <= bounds[name][1] for name, share in d.shares.items())
    # of the day they were committed: whoever changes how scenarios are drawn makes another study
    keys = hashlib.sha256(" ".join(d.key for d in DRAWS).encode()).hexdigest()
    assert keys.startswith("be72842ce0563ab6")


@pytest.mark.parametrize("d", [d for d in DRAWS if d.category == "spring"][:3], ids=lambda d: d.machine)
def test_a_spring_is_declared_where_there_is_none(d):
    assert f"{STIFFNESS}@{d.port}" in machines.declared(d).declared
    assert machines.declared(d).truth[f"{d.port}.{STIFFNESS}.k"] == 0.0
    assert set(machines.true_case(d).truth) < set(machines.declared(d).truth)


@pytest.mark.parametrize("machine", ["carriage_open", "oscillator", "flexible_link"])
def test_friction_of_another_kind_is_declared(machine, monkeypatch):
    d = next(d for d in DRAWS if (d.category, d.machine) == ("friction", machine))
    monkeypatch.setattr(machines, "amounts", lambda draw: {"coulomb": 1e-3, "quadratic_drag": 2e-3})
    declared, true = (
        {term.name for term in case.model().terms} for case in (machines.declared(d), machines.true_case(d))
    )
    wrong, truths = wrong_and_truths(d.category, d.port)
    assert declared - true == {wrong}
    assert true - declared == truths
    hidden = machines._rest(d).own[d.port]
    assert "coulomb" not in {one.law.name for one in hidden}
    assert ("viscous" in {one.law.name for one in hidden}) == (machine == "flexible_link")  # its back-EMF


def test_laws_take_their_shares():
    d = drawn(1001, "sound_spring", "flexible_link")
    found = machines._shares(d, machines.amounts(d), [0.0, 0.0])
    assert found[STIFFNESS] == pytest.approx(d.shares[STIFFNESS], rel=0.05)


def test_a_spring_that_is_not_there_ends_at_zero():
    answer = traced(SPRING, laws=False, effects=(), ports=())
    assert answer["idle"] == ["servo.linear_stiffness"]
    assert answer["classes"] == answer["replaced"] == []
    assert consult(SPRING) is None
    quiet, _ = machines.records_of(SPRING, quiet=True)
    noisy, other = machines.records_of(SPRING)
    assert noisy.simulated
    assert (noisy.outputs - quiet.outputs).std() == pytest.approx(SPRING.noise, rel=0.1)
    assert not np.array_equal(noisy.inputs, other.inputs)


def _round(category="friction", classes=(), idle=(), replaced=(), detectable=None) -> Round:
    wrong, truths = wrong_and_truths(category, "carriage")
    put = tuple(Replaced(name, tuple(map(tuple, one)), "better", 0.3, 0) for name, one in replaced)
    return Round(
        "k",
        category,
        wrong,
        truths,
        detectable,
        0.5,
        "effect_found",
        tuple(map(tuple, classes)),
        idle,
        put,
        1.0,
    )


ALIKE = [("carriage.stribeck", "carriage.dahl", "carriage.coulomb"), ("carriage.quadratic_drag",)]
WIDE = [("carriage.stribeck", "a", "b", "carriage.coulomb"), ("carriage.quadratic_drag",)]
SPRUNG = f"carriage.{STIFFNESS}"


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (_round(replaced=[(VISCOUS, PAIR)]), "told"),
        (_round(replaced=[(VISCOUS, ALIKE)]), "told"),
        (_round(replaced=[(VISCOUS, WIDE)]), "near, misnamed"),
        (_round(replaced=[(VISCOUS, [("carriage.dahl",), ("carriage.eddy_brake",)])]), "near, misnamed"),
        (_round(replaced=[(VISCOUS, PAIR[:1])]), "other"),
        (_round(replaced=[(VISCOUS, [*PAIR, ("carriage.cogging",)])]), "other, misnamed"),
        (_round(replaced=[(VISCOUS, [("carriage.coulomb",), ("servo.quadratic_drag",)])]), "other, misnamed"),
        (_round(replaced=[(VISCOUS, PAIR), ("carriage.offset", PAIR)]), "other, false"),
        (_round(classes=PAIR, idle=(VISCOUS,)), "told"),
        (_round(classes=PAIR[:1], idle=(VISCOUS,)), "other"),
        (_round(classes=PAIR[:1], idle=(VISCOUS,), replaced=[(VISCOUS, PAIR)]), "told"),
        (_round(classes=PAIR, idle=("carriage.offset",)), "silent, false"),
        (_round(classes=PAIR), "silent"),
        (_round(), "silent"),
        (_round("spring", idle=(SPRUNG,)), "told"),
        (_round("spring", idle=(SPRUNG,), classes=PAIR[:1]), "other, misnamed"),
        (_round("spring", replaced=[(SPRUNG, [("carriage.gravity",)])]), "other, misnamed"),
        (_round("spring", idle=(SPRUNG, "carriage.offset")), "other, false"),
        (_round("sound_spring", idle=(SPRUNG,)), "false"),
        (_round("sound_friction", replaced=[(VISCOUS, PAIR)]), "false, misnamed"),
        (_round("sound_friction", classes=PAIR), "misnamed"),
        (_round("sound_friction"), ""),
    ],
)  # fmt: skip
def test_an_answer_is_scored_as_stated(answer, said):
    assert answer.said == said


def test_the_bars_hold_and_fall():
    told, silent = _round(replaced=[(VISCOUS, PAIR)]), _round("spring")
    quiet, false = _round("sound_friction"), _round("sound_spring", idle=(SPRUNG,))
    assert [bar.holds for bar in asked([told] * 16 + [silent] * 4 + [quiet] * 20)] == [True, True]
    assert [bar.holds for bar in asked([told] * 15 + [silent] * 5 + [quiet] * 19 + [false])] == [False, False]
    assert [bar.holds for bar in asked([told])] == [True, None]
    assert not replace(told, replaced=()).told


def test_a_report_is_written_from_what_is_there(tmp_path, capsys):
    """Answers written by hand, under the digests of today's code."""
    lines = []
    for d in DRAWS[:4]:
        wrong, truths = wrong_and_truths(d.category, d.port)
        put = {"kind": "better", "gain": 0.3, "p_value": 0.0, "fewer": -1}
        pair = [{"left_out": wrong, "classes": [[one] for one in sorted(truths)], **put}]
        told = {"detectable": False, "gain": 0.4, "p_value": 0.1} if d.category == "friction" else None
        ours = {
            "named": [], "classes": [], "replaced": pair if truths else [], "seconds": 90.0,
            "idle": [wrong] if d.category == "spring" else [], "notes": {"verdict": "nothing_missing"},
        }  # fmt: skip
        lines += [{**LEAGUE.line(d, p), "answer": a} for p, a in (("oracle", told), ("ours", ours))]
    (tmp_path / "results.jsonl").write_text("\n".join(map(json.dumps, lines)))
    assert main(["--report", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    for row in (
        "at least 16 of 20 | 2 of 2 | holds |",
        "none | 0 of 2 | holds |",
        "Coulomb friction and drag true | 1 | 1 | 1 | 0 | 0 | 0 | 0 | 0 | 90 |",
        "oracle 40% (not detectable), nothing_missing: nothing; replaced: carriage.viscous → "
        "carriage.coulomb + carriage.quadratic_drag (30 %). **told** (90 s)",
        "**left in peace** (90 s)",
    ):
        assert row in said
    assert (tmp_path / "report.md").read_text() in said


def test_a_list_is_spread_over_the_kinds(capsys):
    assert main(["--list", "--limit", "4"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 4
    assert len(WRONG) == 2
