"""The study of laws: its scenarios are its own, and its page counts what the answers say."""

from __future__ import annotations

import pytest

from benchmarks.drawn.draw import COUNT, all_draws, draw_of
from benchmarks.laws.report import report
from benchmarks.laws.scenarios import EACH, FIRST, STATIC, scenarios

DRAWS = scenarios()


def test_the_scenarios_are_none_of_the_league():
    assert len(DRAWS) == 2 * EACH
    assert len({draw.key for draw in DRAWS}) == len(DRAWS)
    assert min(draw.number for draw in DRAWS) >= FIRST >= COUNT
    assert draw_of(7) == all_draws()[7]
    assert not {draw.key for draw in scenarios(1)} & {draw.key for draw in DRAWS}


def test_half_of_them_hide_an_effect_that_a_law_could_be():
    hidden = [draw.wanted for draw in DRAWS if draw.wanted]
    assert len(hidden) == EACH
    assert {wanted.what for wanted in hidden} <= STATIC
    assert len({wanted.what for wanted in hidden}) >= 8
    assert len({draw.machine for draw in DRAWS}) >= 5


@pytest.fixture
def pair():
    """``pair("cubic_stiffness", ...)``: the oracle's line of a scenario, and ours."""

    def make(key, what, detectable=True, **answer):
        about = {"key": key, "scenario": {"wanted": {"what": what, "ports": ["q"]} if what else None}}
        ours = {"named": [], "names": [], "laws": [], "forms": [], "before": 1.0, "after": 1.0}
        notes = {"notes": {"verdict": "unexplained"}}
        return [
            {**about, "player": "oracle", "answer": {"detectable": detectable, "gain": 0.5}},
            {**about, "player": "ours", "answer": ours | notes | answer},
        ]

    return make


def test_the_page_counts(pair):
    law = {"named": ["q.cube_of_position"], "laws": [["q.cube_of_position"]]}
    lines = [
        *pair("a", "cubic_stiffness", **law, forms=["cubic_stiffness"], after=0.55),
        *pair("b", "stribeck", **law, forms=["cubic_stiffness"], after=0.7),
        *pair("c", "stribeck", named=["q.dahl"], names=[["q.dahl"]], after=0.7),
        *pair("d", "stribeck", detectable=False),
        *pair("g", "coulomb", named=["q.stribeck"], names=[["q.stribeck"]], after=0.5),
        *pair("h", "coulomb", named=["p.stribeck"], names=[["p.stribeck"]], after=0.5),
        *pair("e", None, detectable=False),
        *pair("f", None, detectable=False, **law),
    ]
    text = report(lines)
    for row in (
        "| an effect is hidden, and no library has it | 6 |",
        "| the oracle detects it | 5 |",
        "| a law is proposed | 2 |",
        "| its held-out error is at most 1.2 times the oracle's | 1 |",
        "| the law or one alike has the form of the effect | 1 |",
        "| a physical name is given | 3 |",
        "look-alikes of the effect at its port, and explain as much | 1 |",
        "| nothing is hidden | 2 |",
        "| a name or a law is given all the same | 1 |",
    ):
        assert row in text
    assert "(simulated)" in text
    assert "- d: oracle 50% (not detectable), ours 0%, unexplained: nothing" in text
