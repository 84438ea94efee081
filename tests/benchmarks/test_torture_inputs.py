"""Bad inputs: what is wrong with an answer is seen, and some inputs are really given to a command."""

from __future__ import annotations

import sys
from dataclasses import replace

import pytest

from benchmarks.torture.case import Case, Said, faults
from benchmarks.torture.inputs import trials
from benchmarks.torture.lab import fit

CASE = Case("one", tuple(fit()))
GOOD = Said(2, "", "hybridid: record swing: 'abc' in column angle, line 5, is no number\n", 0.1)


def test_a_clear_line_is_no_fault():
    assert list(faults(CASE, GOOD)) == []


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"code": 0}, "exit code 0, expected 1 or 2"),
        ({"code": -11}, "exit code -11"),
        ({"seconds": 61.0}, "no answer within 60 s"),
        ({"err": "Traceback (most recent call last)\n  x\nKeyError: 'q'\n"}, "a traceback"),
        ({"err": "Killed\n"}, "the last line is no message of hybridid"),
        ({"err": "hybridid: " + "x" * 9649}, "a line of 9659 characters"),
        ({"err": "hybridid: KeyError: 'q'; --debug shows where\n"}, "a raw exception"),
        ({"err": "hybridid: record swing: record swing: no\n"}, "says a part twice"),
        ({"left": ("tree/.unfinished-x",)}, "left behind: tree/.unfinished-x"),
    ],
)
def test_each_fault_of_an_answer_is_seen(changes, what):
    assert any(found.startswith(what) for found in faults(CASE, replace(GOOD, **changes)))


def test_the_inputs_are_many_and_drawn_from_their_seed():
    first, again, other = trials(20), trials(20), trials(21)
    assert len(first) >= 3000
    assert len({one.key for one in first}) == len(first)
    assert [one.case.files for one in first] == [one.case.files for one in again]
    assert [one.case.files for one in first] != [one.case.files for one in other]


@pytest.mark.skipif(sys.platform != "linux", reason="each input has a process that is forked")
def test_some_of_the_inputs_cost_one_line_each(tmp_path):
    every = trials(20)
    tables = {one.category: one for one in every if one.category.startswith(("own ", "case files"))}
    given = [*every[7:3000:1000], *tables.values()]
    assert [(one.key, one.carried_out(tmp_path).faults) for one in given] == [(one.key, ()) for one in given]
