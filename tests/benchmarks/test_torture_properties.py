"""Whatever is drawn is understood or refused in one line: the same few examples in each run."""

from __future__ import annotations

import pytest
from hypothesis import strategies as st

from benchmarks.torture import properties
from benchmarks.torture.bench import WRONG

EXAMPLES = {
    "a table as CSV": 60,
    "the bytes of a recording": 60,
    "a value of a key": 200,
    "a changed model.json": 25,
}


@pytest.mark.parametrize("name", properties.PROPERTIES)
def test_it_holds(name):
    properties.check(name, EXAMPLES[name])


def test_what_breaks_is_shrunk_and_told(tmp_path, monkeypatch):
    def below(number):
        assert number < 50

    monkeypatch.setitem(properties.PROPERTIES, "numbers", (st.integers, below))
    (fault,) = properties.Property("numbers", 0, 20).carried_out(tmp_path).faults
    assert fault.kind == WRONG
    assert "AssertionError" in fault.what
    assert "50" in fault.what
    monkeypatch.setitem(properties.PROPERTIES, "numbers", (st.integers, lambda number: None))
    assert properties.Property("numbers", 0, 20).carried_out(tmp_path).faults == ()
