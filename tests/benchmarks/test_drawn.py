"""The drawn league: its draws are fixed, its laws do what they say, its scores add up. All is simulated."""

from __future__ import annotations

import hashlib
import json
from collections import Counter

import numpy as np
import pytest

from benchmarks.answers import digest, evenly
from benchmarks.drawn import play
from benchmarks.drawn.__main__ import main
from benchmarks.drawn.amount import made, records_of, simulated
from benchmarks.drawn.draw import (
    CATEGORIES,
    COUNT,
    LEAST,
    MOST,
    NOISE,
    NOMINAL,
    SHARES,
    Draw,
    Wanted,
    _draw,
    all_draws,
    draw_of,
)
from benchmarks.drawn.hidden import concealed
from benchmarks.drawn.laws import LOAD_FRICTION, VARYING_INERTIA
from benchmarks.drawn.machines import bench_of, case_of
from benchmarks.drawn.offers import COMPOSED, LIBRARY, OUTSIDE, composed_factors
from benchmarks.drawn.oracle import consult
from benchmarks.drawn.recipes import Moving
from benchmarks.drawn.scoring import TRUTH_IDS, Round, asked, named, truths_of
from benchmarks.drawn.shapes import Factor, composed
from benchmarks.drawn.told import ToldMotion
from benchmarks.league.machines import CASES
from benchmarks.league.planting import PATHS
from benchmarks.league.scenarios import all_scenarios
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.rigs.law_library import VISCOUS
from hybridid.rigs.machine import Machine

DRAWS = all_draws()
OFFERS = sorted(
    {
        (m, *one)
        for part in (LIBRARY, OUTSIDE)
        for m, rows in part.items()
        for one in rows
        if one[0] != COMPOSED
    }
)
MOVING = Moving(0.05, -0.08, 0.1, 0.1, 0.6, 60.0, 8.0, 2.5e-3, 200.0)


def test_draws_are_fixed_and_distinct():
    assert len(DRAWS) == COUNT == len({d.key for d in DRAWS}) == len({digest(d, "") for d in DRAWS})
    for d in DRAWS[::7]:
        assert _draw(d.number, d.category) == d
    assert Counter(d.category for d in DRAWS) == SHARES
    assert len({d.seed for d in DRAWS}) == COUNT
    # of the day they were committed: whoever changes how scenarios are drawn makes another league
    keys = hashlib.sha256(" ".join(d.key for d in DRAWS).encode()).hexdigest()
    assert keys.startswith("d9cb36e58a65781d")


def test_a_further_series_is_drawn_anew():
    other = all_draws(series=1)
    assert not {d.noise for d in DRAWS} & {d.noise for d in other}
    assert not {d.seed for d in DRAWS} & {d.seed for d in other}
    assert Counter(d.category for d in other) == SHARES
    assert draw_of(other[5].number) == other[5]


def test_draws_are_within_what_is_stated():
    for d in DRAWS:
        assert (d.wanted is None) == (d.category == "nothing")
        assert NOISE[d.machine][0] <= d.noise <= NOISE[d.machine][1]
        for name, value in d.parameters.items():
            assert 2**-0.5 <= value / NOMINAL[d.machine][name] <= 2**0.5
        if d.wanted:
            assert LEAST <= d.wanted.share <= MOST
    machines = Counter(d.machine for d in DRAWS)
    assert set(machines) == set(NOMINAL)
    assert machines["half_car"] + machines["esea"] < COUNT / 4, "most scenarios must be cheap"


def test_no_draw_is_a_scenario_of_the_league():
    old = {(s.machine, s.noise) for s in all_scenarios()}
    assert not old & {(d.machine, d.noise) for d in DRAWS}


def test_what_is_called_library_is_in_it_and_the_rest_was_not():
    ids = {effect.id for effect in EFFECTS}
    for d in DRAWS:
        if d.category == "library":
            assert d.wanted.what in ids
            assert truths_of(d.wanted.what, d.wanted.ports) == set(d.wanted.names)
        if d.wanted and d.wanted.factors:
            assert not set(TRUTH_IDS.get(d.wanted.what, ())) & {"friction_drift", "position_friction"}


@pytest.mark.parametrize(("machine", "what", "ports"), OFFERS)
def test_every_law_on_offer_can_be_planted(machine, what, ports):
    """Its recipe names every value that the law needs; an effect of the library exists at that port."""
    draw = next(d for d in DRAWS if d.machine == machine)
    for port in ports:
        if what in PATHS:
            assert effect_named(what).admissible_at(case_of(draw).plant.port(port))
            continue
        one = concealed(draw, Wanted(what, ports, 0.1, (0.2, 0.4, 0.6, 0.8)), port, 6.0, MOVING)
        assert one.planted.what.values[0][1] != 0.0
        if what in {name.split(".")[1] for name in truths_of(what, [port], plant=case_of(draw).plant)}:
            # the load is what the law sees, no parameter of the effect; the library's loop that stiffens has
            # gamma = 1, for f_c and s say as much
            known = {p.name for p in one.effect.parameters} | {"q_0", "load", "gamma"}
            # more mass about one place: the library has it to second order in the position
            assert set(one.truth) <= known or what == "varying_inertia"


@pytest.mark.parametrize("machine", NOMINAL)
def test_composed_laws_are_finite_and_scale_with_their_amount(machine):
    generator = np.random.default_rng(0)
    draw = next(d for d in DRAWS if d.machine == machine)
    for _ in range(40):
        wanted = Wanted(
            "", ("p",), 0.1, tuple(generator.uniform(size=4)), 1, composed_factors(generator, machine)
        )
        once, twice = (concealed(draw, wanted, "p", a, MOVING).planted.what for a in (1.0, 2.0))
        z = np.array([0.05, 0.3])
        forces = [
            law.law.function(1.3, 0.04, 0.11, 1.0, z, np.array([x for _, x in law.values]), np.zeros(2))
            for law in (once, twice)
        ]
        assert np.isfinite(forces).all()
        assert forces[1] == pytest.approx(2 * forces[0])


def test_a_composed_law_is_its_formula():
    f, g = Factor("direction", "velocity"), Factor("modulus", "load")
    values = {"amplitude": 3.0, "load": -5.0, "tau_a": 1.0, "tau_r": 1.0}
    law = composed(f, g)(**values, **f.numbers("f", 0.0, 1.0), **g.numbers("g", 0.0, 2.0))
    p = np.array([x for _, x in law.values])
    assert law.law.dry
    for s in (-1.0, 1.0):
        assert law.law.function(0.0, 0.0, 0.1 * s, s, np.zeros(2), p, np.zeros(2)) == 3.0 * s * 2.5


def _mass(*laws, back_emf=0.0) -> ToldMotion:
    return ToldMotion(Machine(((2.0,),), ((1.0,),), ((1.0,),), (laws,)), back_emf=back_emf)


def test_friction_of_the_load_takes_its_part_of_the_drive():
    """Under a constant force u: a = u (1 - mu) / M, whatever u is; told anew, it follows."""
    motion = _mass(LOAD_FRICTION(mu=0.25, load=0.0))
    motion.advance(0.5, np.array([4.0]))
    assert motion.velocities[0] == pytest.approx(4.0 * 0.75 / 2.0 * 0.5)
    assert motion.effort(0) == pytest.approx(1.0)
    motion.advance(0.5, np.array([12.0]))
    assert motion.velocities[0] == pytest.approx((4.0 + 12.0) * 0.75 / 2.0 * 0.5)


def test_friction_of_the_load_takes_its_part_of_what_the_back_emf_leaves():
    """M v' = (1 - mu) (u - e v) has the solution v = u / e (1 - exp(-(1 - mu) e t / M))."""
    u, e, mu = 4.0, 3.0, 0.25
    motion = _mass(VISCOUS(f_v=e), LOAD_FRICTION(mu=mu, load=0.0), back_emf=e)
    for _ in range(100):
        motion.advance(4e-3, np.array([u]))
    assert motion.velocities[0] == pytest.approx(u / e * (1 - np.exp(-(1 - mu) * e * 0.4 / 2.0)), rel=1e-5)


def test_an_inertia_that_varies_keeps_energy():
    own = {"M": 2.0, "f_v": 0.0, "f_c": 0.0, "offset": 0.0, "k": 0.0}
    motion = _mass(VARYING_INERTIA(dm=1.0, load=0.0, q_0=0.3, width=0.1, **own))
    work = 0.0
    for k in range(800):
        before, u = motion.positions[0], 1.0 if k < 100 else 0.0
        motion.advance(5e-3, np.array([u]))
        work += u * (motion.positions[0] - before)
        m = 2.0 + np.exp(-(((motion.positions[0] - 0.3) / 0.1) ** 2))
        assert 0.5 * m * motion.velocities[0] ** 2 == pytest.approx(work, rel=1e-5)
    assert motion.positions[0] > 0.6


SOME = [
    next(d for d in DRAWS if d.machine == "carriage" and d.wanted and d.wanted.what == "following_friction"),
    next(d for d in DRAWS if d.machine == "carriage_open" and d.category == "library"),
]


@pytest.mark.parametrize("draw", SOME, ids=lambda d: d.key)
def test_what_is_hidden_changes_the_records_by_its_share(draw):
    hidden = made(draw.number)
    assert hidden.share == pytest.approx(draw.wanted.share, rel=0.05)
    first, second = records_of(draw)
    again, _ = records_of(draw)
    empty, _ = records_of(draw, empty=True)
    assert first.simulated
    assert np.array_equal(first.outputs, again.outputs)
    assert not np.array_equal(first.inputs, second.inputs)
    changed = np.abs(first.outputs - empty.outputs).max() / draw.noise
    moved = np.abs(first.inputs - empty.inputs).max() / np.abs(empty.inputs).max()
    assert changed > 3 or moved > 0.01
    quiet, _ = records_of(draw, quiet=True)
    assert (first.outputs - quiet.outputs).std() == pytest.approx(draw.noise, rel=0.05)


def test_the_half_car_hides_the_same_at_both_axles():
    draw = next(d for d in DRAWS if d.wanted and len(d.wanted.ports) == 2)
    hidden = made(draw.number).hidden
    assert {one.port for one in hidden} == set(draw.wanted.ports)
    a, b = (simulated(draw, part, "validation", 0.0).record.outputs for part in (hidden, hidden[:1]))
    assert np.abs(a - b).max() > draw.noise


def test_the_declared_model_knows_what_is_drawn():
    for machine in NOMINAL:
        draw = next(d for d in DRAWS if d.machine == machine)
        case = case_of(draw)
        assert set(case.truth) == {p.name for p in case.model().free}
        if machine != "half_car":
            assert set(bench_of(draw).contacts) == {p.name for p in case.plant.ports if p.kind == "effort"}


def test_the_oracle_sees_what_is_hidden_and_nothing_where_nothing_is():
    hiding = SOME[1]
    found = consult(hiding)
    assert found.detectable
    assert found.left[0] > found.numerics[0]
    empty = next(d for d in DRAWS if d.machine == "oscillator" and d.wanted is None)
    assert consult(empty).noncentrality == 0.0
    assert not consult(empty).detectable


def _round(hidden: str | None = "coulomb", verdict: str = "effect_found", classes=(), **more) -> Round:
    truths = truths_of(hidden, ("p",), {"coulomb", "dahl"}) if hidden else frozenset()
    values = {"detectable": hidden is not None, "gain": 0.5, "over_noise": 1.0, "seconds": 1.0, **more}
    return Round("k", "m", hidden, truths, verdict=verdict, classes=tuple(map(tuple, classes)), **values)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (_round(classes=[["p.coulomb"]]), "right"),
        (_round(classes=[["p.coulomb", "a", "b", "c"]]), "right"),
        (_round(classes=[["a", "b", "p.coulomb"]]), "right"),
        (_round(classes=[["a", "b", "c", "p.coulomb"]]), "wide"),
        (_round(classes=[["q.coulomb"]]), "wrong"),
        (_round(classes=[["p.coulomb"], ["p.dahl"]]), "right, wrong"),
        (_round(verdict="unexplained"), "honest"),
        (_round(verdict="nothing_missing"), "silent"),
        (_round(verdict="nothing_missing", over_noise=3.1), "silent, all clear"),
        (_round(verdict="nothing_missing", detectable=False), "honest"),
        (_round("eddy_brake", verdict="unexplained"), "honest"),
        (_round("eddy_brake", classes=[["p.dahl"]]), "wrong"),
        (_round(None, verdict="nothing_missing"), "honest"),
        (_round(None, classes=[["p.dahl"]]), "false discovery"),
    ],
)  # fmt: skip
def test_an_answer_is_scored_as_stated(answer, said):
    assert answer.said == said


def test_the_bars_hold_and_fall():
    right, wrong = _round(classes=[["p.coulomb"]]), _round(classes=[["p.dahl"]])
    none, false = _round(None, verdict="nothing_missing"), _round(None, classes=[["p.dahl"]])
    assert [bar.holds for bar in asked([right] * 19 + [wrong] + [none] * 19 + [false])] == [True] * 4
    assert [bar.holds for bar in asked([right] * 18 + [wrong] * 4 + [none] * 18 + [false] * 2)] == [
        False, False, False, True,
    ]  # fmt: skip
    assert asked([_round(verdict="nothing_missing", over_noise=4.0)])[3].holds is False
    assert asked([right])[2].holds is None


def test_names_are_told_apart_by_the_error_that_they_leave():
    near, far = _round(classes=[["p.coulomb"]]), _round(classes=[["p.dahl"]], over_noise=3.1)
    assert list(named([near, far, _round(verdict="unexplained")]).values()) == [[near], [far]]


def test_a_report_of_other_code_says_that_nothing_is_there(tmp_path, capsys):
    lines = [{**one, "digest": "of another time"} for one in _planted_lines(evenly(DRAWS, CATEGORIES, 1))]
    (tmp_path / "results.jsonl").write_text("\n".join(map(json.dumps, lines)))
    assert main(["--report", "--out", str(tmp_path)]) == 0
    assert "no answer of the code as it is" in capsys.readouterr().out


def test_a_law_counts_as_inside_as_soon_as_the_library_has_it():
    assert truths_of("blow_off", ("p",), {"coulomb"}) == frozenset()
    assert truths_of("blow_off", ("p",), {"blow_off_valve"}) == {"p.blow_off_valve"}


def test_a_law_at_two_ports_is_also_one_effect_at_both():
    assert truths_of("coulomb", ("front", "rear"), {"coulomb"}) == {
        "front.coulomb",
        "rear.coulomb",
        "front+rear.coulomb",
    }
    assert truths_of("load_friction", ("p",), {"load_friction"}) == {"p.load_friction"}
    assert truths_of("two_sided_load_friction", ("p",)) == frozenset()
    plants = {machine: CASES[machine].plant for machine in ("carriage", "oscillator", "flexible_link")}
    assert truths_of("load_friction", ("carriage",), plant=plants["carriage"]) == {"carriage.load_friction"}
    assert truths_of("load_friction", ("servo",), plant=plants["flexible_link"]) == {
        "servo.two_sided_load_friction"
    }
    assert truths_of("load_friction", ("oscillator",), plant=plants["oscillator"]) == frozenset()


def _planted_lines(draws: list[Draw]) -> list[dict]:
    """Answers written by hand, under the digests of today's code."""
    lines = []
    for d in draws:
        named = list(d.wanted.names[:1]) if d.wanted else []
        notes = {
            "verdict": "effect_found" if named else "nothing_missing",
            "classes": [named] if named else [],
        }
        told = {"detectable": bool(named), "gain": 0.4, "p_value": 0.0}
        ours = {"named": named, "seconds": 1.0, "notes": {**notes, "over_noise": [1.0]}}
        answers = zip(play.PLAYERS[:2], (told, ours), strict=True)
        lines += [{**play.line(d, p), "answer": a} for p, a in answers]
    return lines


def test_a_run_goes_on_and_reports_what_is_there(tmp_path, capsys):
    draws = evenly(DRAWS, CATEGORIES, 6)
    assert Counter(d.category for d in draws) == dict.fromkeys(SHARES, 2)
    file = tmp_path / "results.jsonl"
    old = {**_planted_lines(draws)[0], "digest": "of another time"}
    file.write_text("\n".join(map(json.dumps, [*_planted_lines(draws), old])) + '\n{"key": "half a li')
    assert len(play.known(file, DRAWS, play.PLAYERS)) == 12
    assert main(["--report", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "nothing hidden: scenarios 2, honest 2" in said
    assert "names that leave more: no scenario" in said
    data = json.loads((tmp_path / "league.json").read_text())
    assert len(data["rounds"]) == 6
    inside = [d for d in draws if d.wanted and truths_of(d.wanted.what, d.wanted.ports)]
    assert data["groups"]["in the library, detectable"]["right"] == len(inside) >= 2
    assert "simulated" in (tmp_path / "index.md").read_text()


def test_a_list_plays_nothing(capsys):
    assert main(["--list", "--limit", "3"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3
    assert main(["--match", "no such"]) == 2
