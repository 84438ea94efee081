"""The record's figure: which signals share a panel, and that no spike is lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.record import record_plot
from hybridid.records.record import Channel


def lines_by_panel(record):
    figure = record_plot(record).figure
    return {a.get_ylabel(): [line.get_label() for line in a.get_lines()] for a in figure.axes}


def test_a_reference_joins_its_output_and_inputs_stay_alone(record):
    assert lines_by_panel(record) == {
        "force [N]": ["force (input)"],
        "position, reference [mm]": ["position (output)", "reference (auxiliary)"],
    }


@pytest.mark.parametrize(
    ("channel", "factor"), [(Channel("reference", "m"), 1e-3), (Channel("voltage", "V"), 1.0)]
)
def test_signals_of_other_size_or_unit_get_their_own_panel(record, channel, factor):
    other = replace(record, auxiliary=record.auxiliary * factor, auxiliary_channels=(channel,))
    assert len(lines_by_panel(other)) == 3


def test_a_single_sample_s_spike_is_drawn(record):
    (line,) = record_plot(record).figure.axes[0].get_lines()
    assert line.get_ydata().max() == pytest.approx(150.0)
    assert len(line.get_ydata()) < 1300


def test_a_short_record_shows_its_held_input_as_steps(record):
    axes = record_plot(record.part(0, 200)).figure.axes
    assert axes[0].get_lines()[0].get_drawstyle() == "steps-post"
    assert axes[1].get_lines()[0].get_drawstyle() == "default"
    assert axes[-1].get_xlabel() == "time [ms]"


def test_the_caption_counts_the_samples(record):
    assert "24,841 samples at 1000 Hz over 24.8 s" in record_plot(record).caption


def test_many_signals_without_auxiliary_are_all_shown(record):
    outputs = np.column_stack([record.outputs[:, 0] * (1 + k) for k in range(5)])
    channels = tuple(Channel(f"q{k}", "m") for k in range(5))
    many = replace(record, outputs=outputs, output_channels=channels, auxiliary=None, auxiliary_channels=())
    panels = lines_by_panel(many)
    assert sum(len(lines) for lines in panels.values()) == 6
    assert max(len(lines) for lines in panels.values()) == 3


def test_what_stands_still_is_told_and_has_no_panel(record):
    still = np.full((record.n, 1), 7.4)
    beside = replace(record, auxiliary=still, auxiliary_channels=(Channel("supply", "V"),))
    assert lines_by_panel(beside) == {"force [N]": ["force (input)"], "position [mm]": ["position (output)"]}
    heading = record_plot(beside).figure.findobj(lambda a: a.get_gid() == "heading")[0]
    assert "supply 7.4 V" in heading.get_text()
