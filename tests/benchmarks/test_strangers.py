"""The recordings of the study ``strangers``, all simulated; ``tests/hybridid_cli/new`` fits the others."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from benchmarks.strangers import asked, counted, report, servo
from benchmarks.strangers.command import beyond
from benchmarks.strangers.killed import Killed, Trial
from benchmarks.strangers.play import Machine, Outcome, Value, machines
from benchmarks.strangers.rigs import FINE, GAP, LEVEL, _pushed, free_swing
from benchmarks.strangers.tanks import EDGE, overflowing, two_tanks
from pipelines.new.template import kinds, template


def columns(text: str) -> np.ndarray:
    return np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1).T


def test_every_template_has_a_machine():
    assert {one.template for one in machines()} == set(kinds())


def test_the_damper_pushes_in_contact_alone():
    """Nothing over the first half of the gap; then up to the friction; nothing again over twice the gap."""
    q = np.concatenate([np.linspace(0, 4e-3, 4000 * FINE), np.linspace(4e-3, -4e-3, 8000 * FINE)])
    force = _pushed(q)
    assert not force[q[: len(force)] < 0.99 * GAP][: 900 * FINE].any()
    assert force.max() == pytest.approx(LEVEL, rel=1e-3)
    assert force.min() == pytest.approx(-LEVEL, rel=1e-3)
    back = force[4000 * FINE :]
    free = np.sum(back == 0) * 1e-6 / FINE  # m
    assert free == pytest.approx(2 * GAP, rel=0.01)


def test_a_swing_loses_what_its_frictions_take():
    """Coulomb friction ends a free swing; without it, it would swing for ever."""
    _, angle = columns(free_swing(20.0).text)
    late = np.abs(angle[-500:]).max()
    assert 10 < late < 40 < angle[0]
    assert len(free_swing(2.0, more=(25.0, 40.0)).more) == 2


def test_a_tank_spills_over_its_edge():
    (_, _, spilling, below), (_, _, whole, also) = (
        columns(make(1000.0).text) for make in (overflowing, two_tanks)
    )
    over = whole > 100 * EDGE
    assert over.any()
    first = int(np.argmax(over))
    assert spilling[:first] == pytest.approx(whole[:first], rel=0.1)
    assert spilling[over].max() < whole[over].max()
    assert below[-100:].mean() <= also[-100:].mean() + 0.1


def outcome(seconds: float, python: int = 0, **more: Any) -> Outcome:
    kind = Machine("slide", "carriage", free_swing, planted=bool(more.get("lacking")))
    values = {"M": Value(2.02, 0.01, 2.0, "kg"), "f_v": Value(3.0, 0.02, 3.0, "N*s/m")}
    return Outcome(kind, (2.0, 9.0, seconds), (1.0, 3.0, 12.0), python, "Nothing.", values, **more)


def test_the_table_counts_what_keeps_each_limit():
    rows = [outcome(30.0, lacking=(), report=True), outcome(300.0, 4, lacking=(), report=False)]
    text = report.templates(rows)
    assert "(simulated)" in text.splitlines()[0]
    assert "| slide | carriage | 3 | 0 | 2, 9, 30 | 16 | 1.00 % (M) | Nothing. |" in text
    assert text.endswith(
        "Of 2 machines (simulated): at most 300 s 1, at most 10 commands 2, no line of Python 1, "
        "a page of the trace 1."
    )


def test_each_line_of_the_issue_is_answered_by_what_was_found():
    quick, slow = outcome(30.0, lacking=(), report=True), outcome(300.0, lacking=(), report=True)
    said = asked.of_templates([quick, slow])
    assert not said.holds
    assert said.found.startswith("1 of 2 machines keep all limits: at most 3 commands, 0 lines of Python")
    assert "beyond a limit: slide; not played: " in said.found
    assert asked.of_rigs([quick]).holds
    assert not asked.of_rigs([outcome(30.0, lacking=(), report=False)]).holds
    sound, late = Trial(0.5, 6, 5, True, True), Trial(0.9, 10, 0, True, True, ended_before=True)
    assert asked.of_killed(Killed(10, 8.0, "Found.", (sound, late))).holds
    for bad in (Trial(0.5, 8, 5, True, True), Trial(0.5, 6, 5, True, False), late):
        assert not asked.of_killed(Killed(10, 8.0, "Found.", (bad,))).holds
    assert not asked.of_servo(None).holds
    assert "| **no** |" in report.answers([said])
    assert "simulated" in report.page([said], ["## a section"])


def test_a_machine_that_is_none_is_refused():
    from benchmarks.strangers.__main__ import _parts_of

    assert _parts_of(["tank", "slide"]) == ["templates", "rigs"]
    with pytest.raises(SystemExit, match="did you mean 'tank'"):
        _parts_of(["tnak"])


def test_what_was_planted_and_not_found_is_told():
    text = report.rigs([outcome(30.0, lacking=("f_c",), report=True)])
    assert "M 2.020 ± 0.020 kg (planted: 2 kg)" in text
    assert "f_c: not in the model" in text


def test_a_kill_that_repeats_work_or_changes_numbers_is_told():
    sound, late = Trial(0.5, 6, 5, True, True), Trial(0.9, 10, 0, True, True, ended_before=True)
    text = report.killed(Killed(10, 8.0, "Found.", (sound, Trial(0.7, 8, 5, True, False), late)))
    assert "| 50 % | 6 | 5 | 1 | the same |" in text
    assert "| 70 % | 8 | 5 | 3 | **differ** |" in text
    assert "2 kills (SIGKILL), at most 3 refits done twice, the same verdict and numbers after 1." in text


def test_each_refit_leaves_a_line_before_it_begins(tmp_path, monkeypatch):
    """A refit that fails has begun."""

    def fails(*_: Any, **__: Any) -> None:
        raise counted.module.TooStiff("at every start")

    monkeypatch.setattr(counted.module, "refit", fails)
    counted.count(tmp_path / "refits.txt")
    for n in (1, 2):
        assert counted.module.refit_if_possible(None, None, [], None, None) is None
        assert (tmp_path / "refits.txt").read_text() == "begun\n" * n


def test_lines_beyond_the_template_are_those_added_or_changed():
    before = {"a.py": ["one", "two"]}
    assert beyond(before, before) == 0
    assert beyond(before, {"a.py": ["one", "2", "three"], "b.py": ["new"]}) == 3


def test_the_servo_is_skipped_with_a_reason(monkeypatch):
    monkeypatch.delenv("HYBRIDID_DATA", raising=False)
    assert servo.records() is None
    assert "**Skipped**: the measured records are not at hand" in report.servo(None)


def test_the_servo_of_the_templates_and_the_measured_one_are_kept_apart(tmp_path):
    from benchmarks.strangers.__main__ import SERVO, TEMPLATES, _folder

    with _folder(tmp_path, SERVO) as measured, _folder(tmp_path, TEMPLATES, SERVO) as simulated:
        assert measured.is_dir()
        assert simulated.is_dir()
        assert measured not in simulated.parents


def test_the_page_s_servo_is_within_the_lines_allowed():
    """The changed lines of the page, made on what the template writes."""
    _, plant, _ = servo.said_on_page()
    text = template("servo").code("xl330", {})
    changed = beyond({"s": text.splitlines()}, {"s": servo.edited(plant, text).splitlines()})
    assert 0 < changed <= servo.ALLOWED
    with pytest.raises(ValueError, match="stands 0 times"):
        servo.edited("-no such line\n+another\n", text)
