"""A small league: its scores add up, and a run goes on where it stopped. Its own numbers come from
``make league``; all of it is simulated.
"""

from __future__ import annotations

import json
import pickle
from dataclasses import replace

import pytest

from benchmarks import answers
from benchmarks.league import ours, play, rivals
from benchmarks.league.__main__ import main
from benchmarks.league.machines import records_of
from benchmarks.league.scenario import CATEGORIES
from benchmarks.league.scenarios import all_scenarios
from benchmarks.league.scoring import EMPTY, Tally, asked, rounds, tallies

ALL = {s.key: s for s in all_scenarios()}
TRIED = ("quadratic_drag", "linear_stiffness")


@pytest.fixture(scope="module")
def small_league(tmp_path_factory, drag, nothing):
    """Ours over a few effects, and the rivals, before one effect, one outside the library and nothing."""
    outside = next(s for s in ALL.values() if s.key.startswith("carriage/carriage.step_disturbance/large"))
    lines = []
    for scenario in (drag[0], outside, nothing):
        records = records_of(scenario)
        for line in play.answer(scenario, ["oracle", "regression"]):
            assert "failure" not in line, line
            lines.append(line)
        said = ours.play(scenario, records, most_effects=1, ids=TRIED, over=("velocity",)).described()
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


def test_a_run_goes_on_where_it_stopped(tmp_path, capsys, monkeypatch, drag):
    """In this process; what is sent to others by pickle has tests of its own."""

    def here(work, todo, processes):
        for key, given in todo.items():
            yield key, work(pickle.loads(pickle.dumps(given)), None)

    monkeypatch.setattr(answers, "side_by_side", here)
    words = [
        "--match",
        drag[0].key,
        "--players",
        "oracle",
        "regression",
        "--processes",
        "1",
        "--out",
        str(tmp_path),
    ]
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


def test_a_line_of_another_version_is_not_used(tmp_path, drag):
    file = tmp_path / "results.jsonl"
    line = {"key": drag[0].key, "player": "oracle", "digest": "of another time", "answer": None}
    file.write_text(json.dumps(line) + "\n")
    assert play.known(file, [ALL[drag[0].key]], ["oracle"]) == {}
    file.write_text(
        json.dumps({**line, "digest": answers.digest(ALL[drag[0].key], play.version("oracle"))}) + "\n"
    )
    assert set(play.known(file, [ALL[drag[0].key]], ["oracle"])) == {(drag[0].key, "oracle")}


def test_a_player_that_fails_is_said_by_name(monkeypatch, nothing):
    def fall(scenario, records):
        raise ArithmeticError("lost")

    monkeypatch.setattr(rivals, "pysindy", fall)
    (line,) = play.answer(nothing, ["pysindy"])
    assert "lost" in line["failure"]


def test_a_limit_spreads_over_the_categories():
    some = play.chosen(ALL.values(), limit=2)
    assert len(some) == 2 * len(CATEGORIES)
    assert play.chosen(ALL.values(), match="no such") == []
    assert main(["--match", "no such"]) == 2
