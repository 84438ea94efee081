"""The stage ``trace`` keeps its numbers where a figure cannot be drawn."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

from hybridid.plotting.trace_waterfall import Level, waterfall_plot
from pipelines.trace.stage import _drawn


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
