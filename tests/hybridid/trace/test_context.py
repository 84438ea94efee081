"""``Context.each``: which refit begins first, and in which order their results come."""

from __future__ import annotations

import time

from hybridid.trace.context import Context


def test_slow_refits_begin_first_and_results_keep_their_order(split_of):
    begun, reported = [], []
    context = Context(
        split_of(), report=lambda stage, done, of, what: reported.append((stage, done, of, what))
    )

    def refit(name: str, states: int) -> str:
        begun.append(name)
        return name.upper()

    given = [("offset", 0), ("dahl", 1), ("drag", 0), ("mass", 2)]
    found = context.each("step 1", refit, given, str, lambda name, states: states)
    assert begun == ["mass", "dahl", "offset", "drag"]
    assert found == ["OFFSET", "DAHL", "DRAG", "MASS"]
    assert reported[:2] == [("step 1", 0, 4, ""), ("step 1", 1, 4, "MASS")]
    assert [done for _, done, *_ in reported] == [0, 1, 2, 3, 4]


def test_in_the_order_given_where_nothing_tells_what_is_slow(split_of):
    assert Context(split_of()).each("step 1", str.upper, [("b",), ("a",)], str) == ["B", "A"]


def test_a_time_limit_leaves_out_the_last_ones_that_may_be_left_out(split_of):
    given = [("a",), ("b",), ("c",)]
    late = Context(split_of(), until=time.monotonic())
    assert late.each("step 1", str.upper, given, str, lambda name: ord(name), always=2) == ["A", "B"]
    assert late.each("pairs", str.upper, given, str, always=0) == []
    assert late.each("in place of", str.upper, given, str) == ["A", "B", "C"], "none may be left out"
    early = Context(split_of(), until=time.monotonic() + 1e3)
    assert early.each("pairs", str.upper, given, str, always=0) == ["A", "B", "C"]
