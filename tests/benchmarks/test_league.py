"""A small league: the rigs hide what they say, the rivals are no straw men, the scores add up, a run goes on
where it stopped. The league's own numbers come from ``make league``; all of it is simulated."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace

import numpy as np
import pytest

from benchmarks import answers
from benchmarks.league import ours, play, rivals
from benchmarks.league.__main__ import main
from benchmarks.league.bench import Drive, Sensor
from benchmarks.league.laws import OUTSIDE
from benchmarks.league.machines import CASES, LINK, records_of
from benchmarks.league.memory import STATES, bristle, relaxing
from benchmarks.league.planting import LIBRARY, Hidden
from benchmarks.league.scenario import CATEGORIES, Scenario
from benchmarks.league.scenarios import all_scenarios
from benchmarks.league.scoring import EMPTY, Tally, asked, rounds, tallies
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.effects.over import RECENT, Over
from hybridid.trace.ceiling import ceiling

ALL = {s.key: s for s in all_scenarios()}
DRAG = "carriage/carriage.quadratic_drag/large/noise1e-07/seed5"
NOTHING = next(s for s in ALL.values() if s.category == "nothing" and s.machine == "carriage")


@pytest.fixture(scope="module")
def drag():
    return ALL[DRAG], records_of(ALL[DRAG])


def test_scenarios_cover_every_category_and_plant():
    assert {s.category for s in ALL.values()} == set(CATEGORIES)
    assert {s.machine for s in ALL.values()} == set(CASES)
    assert len({s.seed for s in ALL.values()}) == len(ALL)
    for s in ALL.values():
        assert bool(s.hidden) == (s.category != "nothing"), s.key
        assert all(h.in_library or s.category == "outside" for h in s.hidden), s.key
    # two that the library has come to know since the league was drawn up
    assert set(OUTSIDE) & LIBRARY == {"eddy_brake", "position_damping"}


@pytest.mark.parametrize("key", ALL)
def test_what_is_planted_has_its_twin_for_the_oracle(key):
    """The effect exists at that port, and knows every value that the truth states."""
    for one in ALL[key].hidden:
        port = CASES[ALL[key].machine].plant.port(one.port)
        assert one.effect.kind == port.kind
        assert set(one.truth) <= {p.name for p in one.effect.parameters} | {"q_0"}
        if not one.on_path:
            assert one.planted.what.law.name


@pytest.mark.parametrize("name", sorted(OUTSIDE))
def test_a_twin_computes_what_its_law_does(name):
    """Outside the library a law is written twice, for the rig and for the oracle: they must agree."""
    import casadi as ca

    one = next(h for s in ALL.values() for h in s.hidden if h.what == name)
    effect, law = one.effect, one.law
    values = np.array([one.values[n] for n, _ in law.parameters])
    symbols = {p.name: ca.SX(one.values[p.name]) for p in effect.parameters}
    from types import SimpleNamespace

    from hybridid.effects.effect import Local

    for q, v in ((0.1, 0.13), (0.09, -0.05), (-0.02, 0.4), (0.1, -0.7)):
        z, rates = np.full(law.states, 0.02), np.zeros(law.states)
        expected = law.function(4.01, q, v, np.sign(v), z, values, rates)
        at = Local(
            p=SimpleNamespace(**symbols),
            z=SimpleNamespace(**{s.name: ca.SX(0.02) for s in effect.states}),
            time=ca.SX(4.01), epsilon=1e-6, position=ca.SX(q), velocity=ca.SX(v),
        )  # fmt: skip
        assert float(ca.evalf(ca.SX(effect.law(at)))) == pytest.approx(expected, rel=1e-3, abs=1e-3)
        if law.states:
            (rate,) = effect.dynamics(at).values()
            assert float(ca.evalf(rate)) == pytest.approx(rates[0], rel=1e-6)


def test_a_drive_delays_and_lags_what_it_is_told():
    """A mass alone under a step of input: position and velocity are then known in closed form."""
    dt, delay, lag = LINK.dt, 0.0055, 0.02
    free = {"servo": LINK.own["servo"][:0], "link": LINK.own["link"]}
    step = replace(LINK, own=free, runs={"step": lambda t: np.ones_like(t)}, duration=0.2, dt=dt)
    plain, late, slow, seen = (
        made.record("step", dict.fromkeys(LINK.outputs, sensor), seed=0).outputs[:, 0]
        for made, sensor in (
            (step, Sensor(0.0)),
            (replace(step, drive=Drive(delay=delay)), Sensor(0.0)),
            (replace(step, drive=Drive(lag=lag)), Sensor(0.0)),
            (step, Sensor(0.0, lag=lag)),
        )
    )
    time = dt * np.arange(len(plain))
    shifted = np.interp(time[5:] - delay, time, plain)
    assert late[5:] == pytest.approx(shifted, rel=0.01, abs=5e-4 * plain[-1])
    # of a linear machine at rest, a lag may stand before it or behind it
    assert slow == pytest.approx(seen, rel=0.01, abs=2e-3 * plain[-1])
    assert abs(slow - plain).max() > 0.1 * plain[-1]


def test_coloured_noise_is_as_loud_as_it_says():
    noise = Sensor(3.0, memory=0.9).disturbance(200_000, np.random.default_rng(0))
    assert noise.std() == pytest.approx(3.0, rel=0.02)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(0.9, abs=0.01)


def test_states_along_a_motion_are_those_of_the_effects():
    """Against a fine Euler integration of the library's own dynamics."""
    from types import SimpleNamespace

    import casadi as ca

    from hybridid.effects.effect import Local

    dt, fine = 2e-3, 200
    time = dt * np.arange(800)
    v, a = 0.1 * np.sin(5 * time), 0.5 * np.cos(5 * time)
    for name, compute in STATES.items():
        effect = effect_named(name)
        port = CASES["carriage"].plant.port("carriage")
        p = {q.name: q.guess * q.scale_at(port) for q in effect.parameters}
        z = ca.SX.sym("z", len(effect.states))
        now = ca.SX.sym("now", 2)
        at = Local(
            p=SimpleNamespace(**{k: ca.SX(x) for k, x in p.items()}),
            z=SimpleNamespace(**{s.name: z[i] for i, s in enumerate(effect.states)}),
            time=ca.SX(0), velocity=now[0], acceleration=now[1],
        )  # fmt: skip
        rates = effect.dynamics(at)
        step = ca.Function(
            "step", [z, now], [z + dt / fine * ca.vertcat(*[rates[s.name] for s in effect.states])]
        )
        many = step.mapaccum(fine)
        x, expected = np.zeros(len(effect.states)), []
        for k in range(len(time)):
            expected.append(x)
            inside = time[k] + dt / fine * (np.arange(fine) + 0.5)
            moved = np.vstack([0.1 * np.sin(5 * inside), 0.5 * np.cos(5 * inside)])
            x = many(x, moved).full()[:, -1]
        # the first state alone: of a load that knocks, velocities jump at instants that differ a little
        made, reference = compute(v, a, dt, p)[:, 0], np.array(expected)[:, 0]
        assert np.sqrt(np.mean((made - reference) ** 2)) < 0.05 * np.sqrt(np.mean(reference**2)), name


def test_a_bristle_saturates_and_a_branch_relaxes():
    v = np.full(2000, 0.05)
    assert bristle(v, 1e-3, 2e-3, 0.0, 1.0)[-1, 0] == pytest.approx(1.0)
    assert relaxing(v, 1e-3, 0.1)[-1, 0] == pytest.approx(0.005, rel=1e-6)


EFFORTS = [
    s for s in ALL.values() if s.category == "clean" and s.machine == "carriage" and not s.hidden[0].on_path
]
REGRESSED = [s.key for s in EFFORTS][::7]


@pytest.mark.parametrize("key", REGRESSED)
def test_the_regression_names_what_a_clean_carriage_hides(key):
    found = rivals.regression(ALL[key], records_of(ALL[key]))
    assert found.named[:1] == (ALL[key].truth,)
    assert found.after < 0.9 * found.before


def test_the_regressions_name_nothing_where_nothing_is():
    """PySINDy knows no test of significance: what it says of an empty record is its own affair."""
    records = records_of(NOTHING)
    for player in (rivals.regression, rivals.own_cutoff, rivals.with_memory):
        assert player(NOTHING, records).named == ()


def test_the_regression_derives_what_of_a_car_is_not_measured():
    (key,) = (k for k in ALL if k.startswith("half_car/front_suspension.asymmetric_damper/large/noise0.0002"))
    found = rivals.regression(ALL[key], records_of(ALL[key]))
    assert found.named[0] == ALL[key].truth
    assert found.values["dc"] == pytest.approx(2000.0, rel=0.1)


def test_pysindy_names_a_plain_effect(drag):
    found = rivals.pysindy(*drag)
    assert found.named[0] == "carriage.quadratic_drag"
    assert found.after < 0.5 * found.before


def test_the_oracle_finds_what_it_is_told(drag):
    found = ours.consult(*drag)
    assert found is not None
    assert found.detectable
    assert found.error["carriage.quadratic_drag.c_d"] < 0.05
    assert ours.consult(NOTHING, records_of(NOTHING)) is None


TRIED = ("quadratic_drag", "linear_stiffness")


@pytest.fixture(scope="module")
def small_league(tmp_path_factory, drag):
    """Ours over a few effects, and the rivals, before one effect, one outside the library and nothing."""
    outside = next(s for s in ALL.values() if s.key.startswith("carriage/carriage.step_disturbance/large"))
    lines = []
    for scenario in (drag[0], outside, NOTHING):
        records = records_of(scenario)
        for line in play.answer(scenario, ["oracle", "regression"]):
            assert "failure" not in line, line
            lines.append(line)
        said = ours.play(scenario, records, most_effects=1, ids=TRIED, over=("velocity", "time")).described()
        lines.append({**lines[-1], "player": ours.NAME, "answer": said})
    return json.loads(json.dumps(lines, default=float))


def test_ours_names_what_is_hidden_and_nothing_where_nothing_is(small_league):
    by = {(r.category, r.player): r for r in rounds(small_league)}
    assert by["clean", ours.NAME].top
    assert by["clean", ours.NAME].parameter_error < 0.05
    assert by["nothing", ours.NAME].top
    assert by["outside", ours.NAME].first is None
    assert by["clean", ours.NAME].answer["after"] < 0.2 * by["clean", ours.NAME].answer["before"]


def test_scores_add_up(small_league):
    found = rounds(small_league)
    table = tallies(found)
    assert set(table) == {"clean", "outside", "nothing"}
    assert table["clean"][ours.NAME].covered == table["clean"][ours.NAME].scenarios == 1
    said = {line.what: line for line in asked(found, ours.NAME)}
    assert said["false discoveries where nothing is missing, at most 5 %"].holds
    wrong = [replace(r, answer={**r.answer, "named": ["x.y"], "alike": ["x.y"]}) for r in found]
    for line in asked(wrong, ours.NAME)[:1] + asked(wrong, ours.NAME)[2:4]:
        assert line.holds is False
    tally = Tally.of([r for r in wrong if r.player == ours.NAME])
    assert (tally.top, tally.abstained) == (0, 0)


def test_a_class_covers_but_is_not_first(small_league):
    (one,) = (r for r in rounds(small_league) if r.player == ours.NAME and r.category not in EMPTY)
    other = replace(
        one, answer={**one.answer, "named": ["carriage.viscous"], "alike": ["carriage.viscous", one.truth]}
    )
    assert other.covered
    assert not other.top


def test_a_run_goes_on_where_it_stopped(tmp_path, capsys, monkeypatch):
    """In this process; what is sent to others by pickle has tests of its own."""

    def here(work, todo, processes):
        for key, given in todo.items():
            yield key, work(pickle.loads(pickle.dumps(given)), None)

    monkeypatch.setattr(answers, "side_by_side", here)
    words = ["--match", DRAG, "--players", "oracle", "regression", "--processes", "1", "--out", str(tmp_path)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "0 of 2 answers" in said
    assert (tmp_path / "index.html").read_text().count("simulated") > 3
    assert "quadratic_drag" in (tmp_path / "index.md").read_text()
    file = tmp_path / "results.jsonl"
    text = file.read_text()
    file.write_text(text + '{"key": "half a li')
    assert main(words) == 0
    assert "2 of 2 answers" in capsys.readouterr().out
    assert file.read_text().startswith(text)


def test_a_line_of_another_version_is_not_used(tmp_path):
    file = tmp_path / "results.jsonl"
    line = {"key": DRAG, "player": "oracle", "digest": "of another time", "answer": None}
    file.write_text(json.dumps(line) + "\n")
    assert play.known(file, [ALL[DRAG]], ["oracle"]) == {}
    file.write_text(json.dumps({**line, "digest": ALL[DRAG].digest(play.version("oracle"))}) + "\n")
    assert set(play.known(file, [ALL[DRAG]], ["oracle"])) == {(DRAG, "oracle")}


def test_a_player_that_fails_is_said_by_name(monkeypatch):
    def fall(scenario, records):
        raise ArithmeticError("lost")

    monkeypatch.setattr(rivals, "pysindy", fall)
    (line,) = play.answer(NOTHING, ["pysindy"])
    assert "lost" in line["failure"]


def test_a_limit_spreads_over_the_categories():
    some = play.chosen(ALL.values(), limit=2)
    assert len(some) == 2 * len(CATEGORIES)
    assert play.chosen(ALL.values(), match="no such") == []
    assert main(["--match", "no such"]) == 2


def test_an_unknown_category_is_refused():
    with pytest.raises(ValueError, match="allowed: clean"):
        Scenario("carriage", "easy", (), "none", 0.0)


def test_every_effect_of_the_library_that_a_rig_can_hide_is_hidden():
    hidden = {h.what for s in ALL.values() for h in s.hidden if h.in_library}
    # what is one with the declared terms or the plant's own, or has no place in these rigs
    left = {effect.id for effect in EFFECTS} - hidden
    assert left == {
        "periodic_disturbance",
        "free_play",
        "gravity",
        "added_inertia",
        "sensor_scale",
        "sensor_offset",
        "sensor_nonlinearity",
        "sensor_periodic_error",
        "cyclic_inertia",
        "detent",
        "back_emf_limit",
        # in the drawn league, or there under the names of their laws (heating, blow_off)
        "load_friction",
        "load_stribeck",
        "two_sided_load_friction",
        "input_scaled_friction",
        "friction_behind_play",
        "warming_friction",
        "blow_off_valve",
        "varying_inertia",
        # in the rebuilt rows
        "hardening_hysteresis",
        "overflow",
        "orifice_leak",
        "steady_leak",
        "linear_leak",
        "periodic_flow",
    }
    assert Hidden("dahl", "carriage", {"amplitude": 5.0, "stiffness": 2500.0}).truth["s"] == pytest.approx(
        2e-3
    )


def test_friction_that_warms_is_told_by_a_learned_effort():
    """No effect of the library has it; a learned effort over the recent speed of the contact does."""
    (scenario,) = play.chosen(ALL.values(), match="carriage.heating/large/noise1e-07")
    split = ours._split(scenario, records_of(scenario))
    base = ours._declared(CASES["carriage"].model(), split)
    found = ceiling(base, split, "carriage", Over(RECENT, "sign of velocity"))
    (tau,) = [value for name, value in found.refit.values.items() if name.endswith(".tau")]
    assert found.gain > 0.9
    assert found.p_value < 1e-6
    assert tau == pytest.approx(scenario.hidden[0].values["tau"], rel=0.02)


@pytest.mark.parametrize("machine", CASES)
def test_every_machine_says_the_truth_of_all_that_is_fitted(machine):
    assert set(CASES[machine].truth) == {p.name for p in CASES[machine].model().free}
