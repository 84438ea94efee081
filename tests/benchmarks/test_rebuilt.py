"""The rebuilt rows: their draws are fixed, nothing but what is hidden is missing, their scores add up. All is
simulated."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.answers import digest
from benchmarks.drawn.oracle import declared_score, split_of
from benchmarks.league.machines import RUNS
from benchmarks.rebuilt import benches, dampers, tanks
from benchmarks.rebuilt.__main__ import main
from benchmarks.rebuilt.draw import CATEGORIES, EACH, HALF, PLANTED, ROWS, Draw, _draw, all_draws
from benchmarks.rebuilt.machines import RECORDERS, declared, records_of
from benchmarks.rebuilt.play import LEAGUE, PLAYERS, consult
from benchmarks.rebuilt.scoring import Round, asked, truths_of
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.simulation.stability import MOST, substeps_wanted
from hybridid.trace.context import Context
from hybridid.trace.refits.declared_starts import regressed
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.verdict import conclude

DRAWS = all_draws()
ALL = {**ROWS, **PLANTED}


def first_of(row: str) -> Draw:
    """The first scenario of ``row``, with something missing."""
    return next(d for d in DRAWS if d.row == row)


@cache
def records(row: str, empty: bool = False):
    return records_of(first_of(row), empty=empty)


def test_draws_are_fixed_and_evenly_spread():
    assert len({d.key for d in DRAWS}) == len({digest(d, "") for d in DRAWS}) == len(DRAWS)
    assert [_draw(d.number, d.row, d.category == "missing") for d in DRAWS[:120:9]] == list(DRAWS[:120:9])
    assert Counter(d.category for d in DRAWS) == dict(zip(CATEGORIES, (HALF, HALF, 32, 16), strict=True))
    assert set(Counter((d.row, d.category) for d in DRAWS).values()) == {7, 8}
    # of the day they were committed: whoever changes how scenarios are drawn makes another bench
    keys = hashlib.sha256(" ".join(d.key for d in DRAWS).encode()).hexdigest()
    assert keys.startswith("7e5e27b0576b8740")


def test_a_further_series_is_drawn_anew():
    other = all_draws(series=1)
    assert not {d.key for d in DRAWS} & {d.key for d in other}
    assert [(d.row, d.category) for d in other] == [(d.row, d.category) for d in DRAWS]
    assert not {d.noise for d in DRAWS[:120]} & {d.noise for d in other[:120]}


def test_draws_are_within_what_is_stated():
    for d in (*DRAWS, *all_draws(series=1)):
        row = ALL[d.row]
        assert 0.999 * row.noise[0] <= d.noise <= 1.001 * row.noise[1]
        assert all(2**-0.5 <= value / row.nominal[name] <= 2**0.5 for name, value in d.parameters.items())
        assert all(row.amounts[name][0] <= a <= row.amounts[name][1] for name, a in d.amounts.items())


@pytest.mark.parametrize("row", ROWS)
def test_with_nothing_hidden_the_declared_model_fits_down_to_the_noise(row):
    draw = first_of(row)
    left = declared_score(declared(draw), records(row, empty=True)).rmse / draw.noise
    assert ((left > 0.8) & (left < 1.4)).all(), left


def test_a_trace_also_starts_from_the_guesses():
    """Three sines hide the mass from the regression, and a descent from there ends far above the noise."""
    draw = replace(_draw(1004, "hysteresis", hides=False), kind="sines")
    case, seen = declared(draw), records_of(draw)
    split, model = split_of(case, seen), case.model()
    strayed = refit(model, split, [regressed(model, split)], factors=CONTINUATION)
    assert strayed.score.rmse > 100 * draw.noise
    found = conclude(model, Context(split, effects=(), ports=()))
    assert found.search.final.score.rmse < 1.2 * draw.noise


@pytest.mark.parametrize("row", PLANTED)
def test_what_is_planted_is_seen_by_the_oracle(row):
    """The smaller share at the third level of noise; the declared model's numerics err by less."""
    draw = [d for d in DRAWS if d.row == row][2 * EACH]
    told = consult(draw)
    assert told["detectable"]
    assert max(told["numerics"]) < 1


def test_friction_of_the_load_takes_its_share_of_the_drive():
    """A carriage has no load beside the drive: there mu is the share."""
    draw = first_of("load_friction@carriage")
    law = benches._law(draw, draw.amounts)
    assert dict(law.values)["mu"] == pytest.approx(draw.amounts["share"])


@pytest.mark.parametrize("row", ROWS)
def test_what_is_hidden_is_more_than_the_noise(row):
    draw = first_of(row)
    left = declared_score(declared(draw), records(row)).rmse / draw.noise
    assert (left > 3).all(), left


@pytest.mark.parametrize("row", {first_of(row).machine: row for row in ROWS}.values())
def test_a_machine_is_recorded_again_as_it_was(row):
    draw = first_of(row)
    record, other = RECORDERS.get(draw.machine, benches.record), records(row)[1]
    again, quiet = (record(draw, RUNS[0], noise, draw.amounts) for noise in (draw.noise, 0.0))
    assert np.array_equal(again.outputs, records(row)[0].outputs)
    assert not np.array_equal(again.inputs, other.inputs)
    assert again.simulated
    assert (again.outputs - quiet.outputs).std() == pytest.approx(draw.noise, rel=0.1)


@pytest.mark.parametrize("row", ALL)
def test_truths_are_effects_that_can_act_there(row):
    ids = {effect.id for effect in EFFECTS}
    plant = declared(first_of(row)).plant
    for name in truths_of(row, first_of(row).amounts):
        port, _, effect = name.partition(".")
        if effect in ids:
            assert effect_named(effect).admissible_at(plant.port(port)), name
    assert truths_of(row, {}) == frozenset()


def test_the_stiff_row_is_too_stiff_for_the_explicit_integrator():
    """At the true pre-sliding length, in every draw of the row."""
    for draw in [d for d in DRAWS if d.row == "stiff" and d.amounts]:
        case, split = declared(draw), split_of(declared(draw), records_of(draw))
        (name,) = truths_of("stiff", draw.amounts)
        model = case.model().plus(effect_named(name.split(".")[1]), "damper")
        travelled = float(np.abs(split.records[0].inputs[:, 1]).max()) * dampers.DT
        told = {**case.truth, f"{name}.s": travelled / draw.amounts["stiffness"], f"{name}.f_c": 50.0}
        p = np.array([told.get(q.name, q.guess) for q in model.parameters])
        assert substeps_wanted(model, p, split.records) > MOST


@pytest.mark.parametrize(
    ("step", "sigma", "n"), [(dampers._dahl, 1.0, 1), (dampers._bouc_wen, dampers.SIGMA, 2)]
)
def test_pre_sliding_in_closed_form_solves_its_equation(step, sigma, n):
    """Against an integrator over a path that turns twice."""
    q = z = 0.0
    for target in (1.5, -0.4, 0.3):
        side = np.sign(target - q)

        def rate(_, y, side=side):
            return side - sigma * np.abs(y) ** (n - 1) * y + side * (sigma - 1) * np.abs(y) ** n

        found = solve_ivp(rate, (0.0, abs(target - q)), [z], rtol=1e-10, atol=1e-12)
        z, q = step(z, target - q), target
        assert z == pytest.approx(found.y[0, -1], abs=1e-7)


@pytest.mark.parametrize("row", ["friction_behind_gap", "scaled_friction"])
def test_a_damper_hides_the_same_in_both_runs(row):
    """The true law, fitted to one run, leaves little more than the noise of the other."""
    draw = first_of(row)
    case, split = declared(draw), split_of(declared(draw), records(row))
    (name,) = truths_of(row, draw.amounts)
    model = case.model().plus(effect_named(name.split(".")[1]), "damper")
    hidden = dampers._Hidden.of(row, draw.amounts, dampers._Way.of(draw, dampers.RUNS[0]))
    level = {f"{name}.f_u": hidden.f_c} if row == "scaled_friction" else {f"{name}.f_c": hidden.f_c}
    told = {**case.truth, **level, f"{name}.g": hidden.gap, f"{name}.s": hidden.s}
    start = {q.name: told[q.name] for q in model.parameters if q.name in told}
    assert (refit(model, split, [start]).score.rmse < 1.5 * draw.noise).all()


def test_friction_behind_a_gap_acts_only_beyond_it():
    q = np.concatenate([np.linspace(0.0, 2.0, 201), np.linspace(2.0, -2.0, 401)])
    way = dampers._Way(q, np.gradient(q), level=q, own=np.full_like(q, 20.0))
    amounts = {"share": 0.5, "gap": 0.4 / q.std(), "s": 0.1 / q.std()}
    force = dampers._Hidden.of("friction_behind_gap", amounts, way).effort("friction_behind_gap", way)
    assert np.all(force[q[:201].searchsorted(0.39) :: -1] == 0.0)
    assert force[200] == pytest.approx(10.0)
    back = force[201:]
    assert np.all(back[(q[201:] < 1.85) & (q[201:] > 1.15)] == 0.0)
    assert back[-1] == pytest.approx(-10.0)


def test_an_overflow_limits_the_level_and_fills_the_lower_tank():
    p, pump = first_of("overflow").parameters, np.full(300, 3.0)
    full = tanks._levels(p, pump)[-1]
    held = tanks._levels(p, pump, limit=0.7 * full[0], share=0.0)[-1]
    given = tanks._levels(p, pump, limit=0.7 * full[0], share=1.0)[-1]
    assert 0.7 * full[0] < held[0] < 0.8 * full[0]
    assert held[1] == pytest.approx(held[0] / full[0] * full[1], rel=1e-3)
    assert given[1] == pytest.approx(full[1], rel=1e-3)


def _round(category: str = "missing", verdict: str = "effect_found", classes=(), **more) -> Round:
    truths = frozenset({"p.dahl"}) if category != "nothing" else frozenset()
    values = {"noise": 1.0, "detectable": True, "gain": 0.5, "left": 9.0, "over_noise": 1.0, **more}
    return Round(
        "k", "stiff", "m", category, truths=truths, verdict=verdict,
        classes=tuple(map(tuple, classes)), times=1.0, seconds=1.0, **values,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (_round(classes=[["p.dahl"]]), "right, good"),
        (_round(classes=[["p.dahl", "a", "b", "c"]]), "right, good"),
        (_round(classes=[["a", "b", "p.dahl"]]), "right, good"),
        (_round(classes=[["a", "b", "c", "p.dahl"]]), "wrong"),
        (_round(classes=[["q.dahl"]]), "wrong"),
        (_round(classes=[["p.dahl"], ["p.coulomb"]]), "right, wrong"),
        (_round(verdict="unexplained", over_noise=9.0), "good"),
        (_round(verdict="undecided", over_noise=9.0), "good"),
        (_round(verdict="nothing_missing", over_noise=2.9), "good"),
        (_round(verdict="nothing_missing", over_noise=3.1), "all clear"),
        (_round("nothing", verdict="nothing_missing"), ""),
        (_round("nothing", verdict="unexplained"), "speaks"),
        (_round("nothing", classes=[["p.dahl"]]), "speaks"),
    ],
)  # fmt: skip
def test_an_answer_is_scored_as_stated(answer, said):
    assert answer.said == said


def test_the_bars_hold_and_fall():
    good, wrong = _round(verdict="unexplained"), _round(classes=[["q.dahl"]])
    quiet, speaks = _round("nothing", verdict="nothing_missing"), _round("nothing", verdict="undecided")
    load, lost = (_round("load_friction", classes=[[name]]) for name in ("p.dahl", "p.coulomb"))
    hardly = replace(lost, detectable=False)
    full = [good] * 57 + [wrong] * 3 + [quiet] * 58 + [speaks] * 2 + [load] * 9 + [lost, hardly]
    assert [bar.holds for bar in asked(full)] == [True, True, True, None]
    assert [bar.holds for bar in asked([*full, wrong, speaks, lost])] == [False, False, False, None]


def test_a_page_is_written_from_what_is_there(tmp_path, capsys):
    """Answers written by hand, under the digests of today's code."""
    some = [first_of("stiff"), first_of("backlash"), DRAWS[2 * HALF - 1]]
    lines = []
    for d in some:
        named = sorted(truths_of(d.row, d.amounts))
        notes = {
            "verdict": "effect_found" if named else "nothing_missing",
            "classes": [named] if named else [],
        }
        told = {"detectable": bool(named), "gain": 0.4, "p_value": 0.0, "left": [9.0, 2.0]}
        ours = {"named": named, "seconds": 1.0, "notes": {**notes, "over_noise": [1.0], "times": 1.1}}
        lines += [{**LEAGUE.line(d, p), "answer": a} for p, a in zip(PLAYERS, (told, ours), strict=True)]
    (tmp_path / "results.jsonl").write_text("\n".join(map(json.dumps, lines)))
    assert main(["--report", "--out", str(tmp_path)]) == 0
    assert "2 of 2" in capsys.readouterr().out
    data = json.loads((tmp_path / "rebuilt.json").read_text())
    assert [r["said"] for r in data["rounds"]] == ["right, good", "right, good", ""]
    assert data["rows"]["backlash missing"]["good"] == 1
    assert "simulated" in (tmp_path / "index.md").read_text()


def test_a_list_is_spread_over_the_halves(capsys):
    assert main(["--list", "--limit", "4"]) == 0
    said = capsys.readouterr().out.split()
    assert said[::2] == list(CATEGORIES)
    assert main(["--match", "no such"]) == 2
