"""What the stage ``trace`` tells: a shorter horizon, a figure that cannot be drawn, and how far it is."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.plotting.trace_waterfall import Level, waterfall_plot
from hybridid.records.record import Channel, Record
from pipelines.trace.stage import TRACE, _drawn, _other_horizon, _Report, _time_left


def test_a_figure_that_cannot_be_drawn_costs_only_itself(monkeypatch, tmp_path):
    def figures(found):
        for name, rmse in (("position.waterfall", float("nan")), ("velocity.waterfall", 2.0)):
            yield (
                name,
                partial(waterfall_plot, [Level("declared", rmse)], 0.1, "x", "m", "held out", "simulated"),
            )

    monkeypatch.setattr("pipelines.trace.figures.figures", figures)
    warnings: list[str] = []
    job = SimpleNamespace(folder=tmp_path, watcher=SimpleNamespace(warn=warnings.append))
    (picture,) = _drawn(job, found=None)
    assert picture.path == tmp_path / "velocity.waterfall.svg"
    (warning,) = warnings
    assert warning.startswith("figure position.waterfall cannot be drawn: ")


@pytest.mark.parametrize(
    ("horizon", "warning"),
    [
        (0.2795, ""),  # as many samples as were asked for
        (0.28, ""),
        (
            0.264,
            "horizons of 0.264 s instead of 0.28 s, so that enough horizons can judge; trace.horizon=0.28 "
            "asks for the longer ones all the same",
        ),
        (
            0.56,
            "horizons of 0.56 s instead of 0.28 s, so that one shows the slowest dynamics of the fitted "
            "model; trace.horizon=0.28 asks for the shorter ones all the same",
        ),
    ],
)
def test_a_horizon_of_fewer_or_more_samples_is_told(horizon, warning):
    assert _other_horizon(horizon, 0.28, [recorded(3.0)], []) == warning


def test_no_horizon_is_advised_that_the_records_do_not_give():
    said = _other_horizon(0.264, 0.28, [recorded(3.0)], [recorded(0.8)])
    assert said.endswith("instead of 0.28 s: these records give too few of the longer ones to judge")


def test_an_unstable_model_is_the_reason_for_a_shorter_horizon():
    said = _other_horizon(0.02, 0.28, [recorded(3.0)], [], rate=250.0)
    assert "instead of 0.28 s, since the model is unstable: a small error grows e-fold in 4 ms; " in said


@pytest.mark.parametrize(
    ("elapsed", "ended", "left", "said"),
    [
        (60.0, 10, 20, ", about 2 min left at this pace"),
        (10.0, 10, 20, ""),  # seconds need not be told
        (60.0, 9, 20, ""),  # too few tell how fast it is
        (60.0, 10, 0, ""),
        (0.0, 0, 30, ""),
    ],
)
def test_what_takes_minutes_says_how_long(elapsed, ended, left, said):
    assert _time_left("pairs", elapsed, ended, left) == said


def test_progress_names_what_is_done_last_and_its_pace_is_that_of_the_last_ten(monkeypatch):
    """Ten quick results, then ten that take 30 s each: five more will take as long."""
    told: list[str] = []
    watcher = SimpleNamespace(progress=lambda stage, state, share: told.append(f"{stage}: {state}"))
    clock = iter((0.0, *(0.1 * k for k in range(11)), *(1.0 + 30.0 * k for k in range(1, 11))))
    monkeypatch.setattr("pipelines.trace.stage.time.monotonic", lambda: next(clock))
    report = _Report(SimpleNamespace(watcher=watcher), limited=True)
    for done in range(21):
        report("step 1", done, 25, "carriage.dahl" if done else "")
    assert told[0] == "step 1: 0 of 25 done"
    assert told[10] == "step 1: 10 of 25 done, last carriage.dahl"
    assert told[20] == (
        "step 1: 20 of 25 done, last carriage.dahl, about 2 min left at this pace, more as the slow ones "
        "come last"
    )


@pytest.mark.parametrize("limited", [False, True])
def test_a_long_trace_says_once_how_it_can_be_ended(monkeypatch, limited):
    said: list[str] = []
    watcher = SimpleNamespace(progress=lambda *given: None, say=said.append)
    clock = iter([0.0, *(100.0 * k for k in range(20))])
    monkeypatch.setattr("pipelines.trace.stage.time.monotonic", lambda: next(clock))
    report = _Report(SimpleNamespace(watcher=watcher), limited)
    for done in range(1, 9):
        report("step 1", done, 20, "carriage.dahl")
    assert len(said) == (not limited)
    assert limited or "with trace.time_limit=SECONDS it ends after so long" in said[0]


def recorded(seconds: float) -> Record:
    n = round(seconds / 0.01)
    time, nothing = np.arange(n) * 0.01, np.zeros((n, 1))
    return Record("run", time, nothing, nothing, (Channel("force", "N"),), (Channel("position", "m"),))


def test_a_trace_depends_on_the_horizon_that_it_takes_from_the_validation(settings):
    """With ``trace.horizon=auto``."""
    one, other = (TRACE.options(settings({"validate": {"horizon": h}})) for h in (0.1, 1.0))
    assert one != other
