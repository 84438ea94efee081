"""Remarks on records: what is said of many is said once, with their number."""

from __future__ import annotations

from pipelines.shared.remarks import together


def test_what_differs_in_numbers_only_is_one_line_that_counts():
    remarks = {
        name: [f"record {name}: resampled from steps of {step} to 7.1e-03 s", f"record {name}: own {name}"]
        for name, step in (("a", 0.0034), ("b", 0.0052), ("kp100", -1e-3))
    }
    assert together(remarks) == [
        "3 records, the first a: resampled from steps of 0.0034 to 7.1e-03 s",
        "record a: own a",
        "record b: own b",
        "record kp100: own kp100",
    ]


def test_other_lines_stay_as_they_are():
    assert together({"a": ["record a: clipped at 3 s"], "b": ["a line of no record", "record c: 1"]}) == [
        "record a: clipped at 3 s",
        "a line of no record",
        "record c: 1",
    ]
    assert together({"a": [], "b": []}) == []
