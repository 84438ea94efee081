"""Figures of Chapters 4 and 5 from made-up records and predictions: what each panel shows, what is said."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.records.record import Channel, Record
from hybridid.records.store import save_record
from hybridid.validation import Prediction
from pipelines.shared.predictions import write_prediction
from pipelines.shared.prepared import Prepared
from pipelines.shared.storage import write_json
from pipelines.thesis import figures4, figures5
from pipelines.thesis.chapter5 import FRICTIONS
from pipelines.thesis.look_up import Failed, Missing, NotRun
from pipelines.thesis.page import drawn
from pipelines.thesis.views import Run, Runs

N, DT = 400, 0.01
SIGNALS = {
    "vehicle_narx": (("u_f",), ("vertical_velocity", "pitch_rate"), ("vertical_acceleration",)),
    **dict.fromkeys(FRICTIONS.values(), (("torque",), ("link_velocity",), ())),
}


def made_up_tree(root: Path, experiment: str, hybrid: bool = True) -> Path:
    """Records of sines, a gray box with an error of 20 %, a hybrid with one of 5 %."""
    tree = root / experiment
    (tree / "preprocess").mkdir(parents=True)
    (tree / "validate").mkdir()
    rows = []
    for role, rate in (("identification", 2.0), ("validation", 3.0)):
        record = made_up_record(role, rate, SIGNALS[experiment])
        save_record(record, tree / f"preprocess/{role}.parquet")
        file = Path(f"preprocess/{role}.parquet")
        rows.append(Prepared(role, role, "simulated", file, "", record.digest, record.n, DT, (), (), (), ()))
        write_prediction(tree / "validate", prediction(record, 0.8), "gray box", None)
        if hybrid:
            write_prediction(tree / "validate/hybrid", prediction(record, 0.95), "hybrid, a network", None)
    write_json(tree / "preprocess/records.json", rows)
    return tree


def made_up_record(name, rate, signals) -> Record:
    time = np.arange(N) * DT
    inputs, outputs, auxiliary = signals

    def columns(names):
        return np.column_stack([np.sin(rate * time + k) for k, _ in enumerate(names)])

    return Record(
        name, time, columns(inputs), columns(outputs),
        tuple(Channel(n, "m") for n in inputs), tuple(Channel(n, "m/s") for n in outputs),
        columns(auxiliary) if auxiliary else None, tuple(Channel(n, "m/s²") for n in auxiliary),
        simulated=True,
    )  # fmt: skip


def prediction(record, share) -> Prediction:
    outputs = tuple(channel.name for channel in record.output_channels)
    return Prediction(
        record.name, "free_run", record.provenance, record.time, record.outputs, share * record.outputs,
        np.zeros((N, 1)), outputs, ("m/s",) * len(outputs), ("x",), (0,), np.zeros((1, 1)),
    )  # fmt: skip


@pytest.fixture
def runs(tmp_path, monkeypatch):
    monkeypatch.setattr(Run, "raw", lambda self, role: made_up_record(role, 2.0, SIGNALS["vehicle_narx"]))
    outcomes = {name: made_up_tree(tmp_path / "trees", name) for name in SIGNALS}
    return Runs({name: SimpleNamespace(case=name) for name in SIGNALS}, outcomes)


def labels(plot):
    return [text.get_text() for text in plot.figure.legends[0].get_texts()]


def titles(plot):
    return [axes.get_title(loc="left") for axes in plot.figure.axes if axes.get_title(loc="left")]


@pytest.mark.parametrize("figure", [*figures4.FIGURES, *figures5.FIGURES], ids=lambda figure: figure.stem)
def test_every_figure_is_drawn_and_says_simulated(runs, figure):
    plot = figure.draw(runs)
    assert plot.provenance == "simulated"
    assert "(simulated)" in plot.caption
    marks = plot.figure.findobj(lambda artist: artist.get_gid() == "provenance")
    assert [mark.get_text() for mark in marks] == ["SIMULATED"]


def test_numbers_are_the_thesis_and_files_differ():
    figures = (*figures4.FIGURES, *figures5.FIGURES)
    assert len({figure.stem for figure in figures}) == len(figures)
    fives = {figure.number for figure in figures5.FIGURES}
    assert fives == {"5.3", "5.4", *(f"5.{k}" for k in range(7, 17))}


def figure_of(number):
    return next(f for f in (*figures4.FIGURES, *figures5.FIGURES) if f.number == number)


def test_gray_box_figures_show_no_hybrid_and_the_others_do(runs):
    assert labels(figure_of("5.7").draw(runs)) == ["simulated", "gray box"]
    assert labels(figure_of("5.10").draw(runs)) == ["simulated", "gray box", "hybrid"]
    assert labels(figure_of("4.7").draw(runs)) == ["simulated", "gray box", "hybrid"]


def test_each_friction_has_its_panel_with_both_errors(runs):
    shown = titles(figure_of("5.15").draw(runs))
    assert [title.partition(":")[0] for title in shown] == list(FRICTIONS)
    rms = 0.2 * np.sqrt(np.mean(np.sin(3 * np.arange(N) * DT) ** 2))  # of 20 % of the sine
    assert f"gray box {rms:.3g}, hybrid {rms / 4:.3g} m/s" in shown[0]


def test_what_the_network_says_is_the_hybrid_less_the_gray_box(runs):
    plot = figure_of("5.9").draw(runs)
    error, network = (line.get_ydata() for line in plot.figure.axes[0].get_lines()[:2])
    assert np.max(np.abs(network)) / np.max(np.abs(error)) == pytest.approx(0.15 / 0.2, rel=1e-3)


def test_a_friction_that_failed_is_left_out_and_named(runs):
    outcomes = {**runs.outcomes, "esea_dahl": Failed("no memory left")}
    plot = figure_of("5.10").draw(Runs(runs.experiments, outcomes))
    assert len(titles(plot)) == 3
    assert "left out: Dahl: failed: no memory left" in plot.caption


def test_without_any_result_the_reason_is_said(runs):
    with pytest.raises(NotRun):
        figure_of("5.10").draw(Runs(runs.experiments, {}))
    failed = dict.fromkeys(FRICTIONS.values(), Failed("no memory left"))
    with pytest.raises(Missing, match="failed: no memory left"):
        figure_of("5.10").draw(Runs(runs.experiments, failed))


def test_a_run_without_a_hybrid_has_its_gray_box_figures_alone(runs, tmp_path, heard):
    tree = made_up_tree(tmp_path / "alone", "vehicle_narx", hybrid=False)
    alone = Runs(runs.experiments, {"vehicle_narx": tree})
    folder = tmp_path / "figures"
    said = drawn(alone, folder, heard)
    assert {path.name for path in folder.iterdir()} == {"figure-4.3.svg", "figure-4.4.svg"}
    assert said["figure-4.7"] == "no prediction of the hybrid"
    assert any("Figure 4.7" in line for line in heard.warned)
