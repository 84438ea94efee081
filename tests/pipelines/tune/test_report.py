"""The page of a search from trials that are known: the choice, the best, what failed and what mattered."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipelines.shared.config import Settings
from pipelines.tune.findings import RULE, Findings, Row
from pipelines.tune.report import command, page_of

FOLDER = Path("outputs/tune/short")
DEPTH, RATE = "residual.depth", "residual.learning_rate"


def trial(number, state, share=None, remark=""):
    weights = 100 + number if state == "done" else None
    return Row(number, state, {DEPTH: 2, RATE: 0.00123456}, share, weights, {}, 0.0, 12.34, remark)


ROWS = (
    trial(0, "done", 0.5),
    trial(1, "done", 0.21234567),
    trial(2, "pruned"),
    trial(3, "failed", remark="no such network"),
    trial(4, "stopped", remark="its process ended"),
)


@pytest.fixture
def page():
    """``page(ROWS, chosen=1)``: the page of these trials, the chosen one by its number."""

    def made(rows, chosen=None, importance=None):
        kept = next((row for row in rows if row.number == chosen), None)
        return page_of(Findings(rows, kept, importance or {}), Settings("short", {}), FOLDER, "measured", [])

    return made


def section(page, title):
    return next(one for one in page.sections if one.title == title)


def test_the_choice_is_said_first_with_its_rule_and_command(page):
    made = page(ROWS, chosen=1)
    assert made.lead == (
        "Chosen: trial 1 with depth 2, learning_rate 0.00123. Of the measured error on the held-out blocks "
        "21.2 % is left, by 101 weights."
    )
    assert made.marks == ("measured",)
    assert section(made, "Trials").paragraphs[1] == f"Choice: {RULE}."
    assert section(made, "Trials").commands == (command(FOLDER),)


def test_the_trials_stand_in_order_of_their_share(page):
    (table,) = section(page(ROWS, chosen=1), "Trials").tables
    assert table.header == ("trial", "held-out share", "weights", "depth", "learning_rate", "s")
    assert table.rows == (
        ("chosen 1", "0.2123", "101", "2", "0.00123", "12.3"),
        ("0", "0.5", "100", "2", "0.00123", "12.3"),
    )
    assert table.caption == "The best 2 of 2"
    assert table.notes == (
        "2 trials finished, 1 were pruned, 1 failed, 1 were stopped from outside and do not count",
    )


def test_the_chosen_trial_is_shown_even_if_it_is_not_among_the_best(page):
    rows = tuple(trial(k, "done", 0.1 + k / 100) for k in range(20))
    (table,) = section(page(rows, chosen=19), "Trials").tables
    assert [row[0] for row in table.rows] == [*(str(k) for k in range(15)), "chosen 19"]


def test_what_failed_and_what_mattered_have_sections_where_there_is_something_to_say(page):
    made = page(ROWS, chosen=1, importance={DEPTH: 0.75, RATE: 0.25})
    (failed,) = section(made, "Failed").tables
    assert failed.rows == (("3", "depth=2 learning_rate=0.00123", "no such network"),)
    assert section(made, "What mattered").tables[0].rows == (("depth", "75 %"), ("learning_rate", "25 %"))
    assert [one.title for one in page(ROWS[:3], chosen=1).sections] == ["Trials", "Course"]


def test_without_a_trial_that_ended_nothing_is_chosen(page, tmp_path):
    made = page(ROWS[2:])
    assert made.lead == "No trial has finished."
    assert section(made, "Trials").commands == ()
    assert "no such network" in made.write(tmp_path).read_text()
