"""What a log shows of long work."""

from __future__ import annotations

import time

from hybridid_cli import terminal
from hybridid_cli.terminal import Terminal


def test_a_log_is_told_that_the_work_goes_on_until_it_ends(monkeypatch, capsys):
    monkeypatch.setattr(terminal, "_SILENCE", 0.05)
    with Terminal() as shown:
        time.sleep(0.1)
        assert capsys.readouterr().err == "", "nothing has begun"
        shown.progress("step 1", "3 of 9", 1 / 3)
        time.sleep(0.3)
    first, *more = [line.split(" ", 1)[1] for line in capsys.readouterr().err.splitlines()]
    assert first == "step 1: 3 of 9"
    assert set(more) == {"step 1: 3 of 9; still at work"}
    assert 2 <= len(more) <= 6
    with Terminal() as shown:
        shown.progress("report", "figures", None)
        capsys.readouterr()
        shown.show("done")
        time.sleep(0.2)
        assert capsys.readouterr().err == "", "the result is there"
    time.sleep(0.1)
    assert capsys.readouterr().err == ""


def test_a_thousand_short_starts_are_a_few_lines(capsys):
    with Terminal() as shown:
        for k in range(1000):
            shown.progress(f"start {k + 1} of 1000", "iteration 1", None)
        shown.progress("standard errors", "1 of 4", None)
    lines = [line.split(" ", 1)[1] for line in capsys.readouterr().err.splitlines()]
    assert lines == ["start 1 of 1000: iteration 1", "standard errors: 1 of 4"]
