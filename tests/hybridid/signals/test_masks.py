"""Masked samples: which they are, and that they keep their places in whatever is made of a record."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.masked import Masked
from hybridid.records.record import RecordError
from hybridid.records.store import load_record, save_record
from hybridid.signals.masks import Keep, Mask, Where
from hybridid.signals.simple import Crop
from hybridid.signals.step import StepError
from hybridid.signals.steps import apply_steps


def test_stretches_are_half_open_and_add_up(record_of):
    record = Mask(stretches=((0.1, 0.2), (0.5, 0.7))).apply(record_of())
    assert record.masked == (Masked(100, 200), Masked(500, 700))
    more = Mask(stretches=((0.15, 0.3),), through=False).apply(record)
    assert more.masked == (Masked(100, 150), Masked(150, 300, False), Masked(500, 700))
    assert more.pieces == [(0, 100), (300, 500), (700, 2000)]
    assert more.joined == [(0, 100), (300, 2000)], "only the stretch that is not simulated parts it"
    assert np.array_equal(more.time, record_of().time)


def test_a_stretch_that_ends_the_record_leaves_nothing_to_simulate_there(record_of):
    record = Mask(stretches=((0.0, 0.1), (1.5, 9.0))).apply(record_of())
    assert record.joined == [(100, 1500)]


@pytest.mark.parametrize(
    ("where", "masked"),
    [
        (Where("force", below=-0.5), lambda u: u < -0.5),
        (Where("force", above=0.25), lambda u: u > 0.25),
        (Where("force", equals=1.0), lambda u: u == 1.0),  # a command of three levels
        (Where("reference", below=1.0), lambda u: np.sin(np.arange(len(u)) * 1e-2) + 1.0 < 1.0),
    ],
)
def test_where_a_signal_says_so(record_of, where, masked):
    levels = where.equals is not None
    record = record_of(u=lambda t: np.round(np.cos(t)) if levels else np.cos(t), dt=1e-2)
    expected = masked(record.input("force"))
    assert expected.any()
    assert np.array_equal(~Mask(where=where).apply(record).counts, expected)
    assert np.array_equal(Keep(where=where).apply(record).counts, expected)


def test_the_margin_goes_to_what_is_masked(record_of):
    wide = {"stretches": ((0.5, 0.7),), "margin": 0.1}
    assert Mask(**wide).apply(record_of()).masked == (Masked(400, 800),)
    assert Keep(stretches=((0.5, 0.9),), margin=0.1).apply(record_of()).pieces == [(600, 800)]
    assert Mask(stretches=((0.0, 0.05),), margin=0.1).apply(record_of()).masked == (Masked(0, 150),)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"step": "mask"}, "give stretches: .* or where"),
        ({"step": "mask", "stretches": [[1, 2]], "where": {"signal": "force", "below": 1}}, "give stretches"),
        ({"step": "mask", "stretches": [[2, 1]]}, "start 2 s is not before stop 1 s"),
        ({"step": "mask", "stretches": [1, 2]}, r"stretches\[0\] has 1 values, expected 2"),
        ({"step": "keep", "stretches": []}, "at least one"),
        ({"step": "mask", "stretches": [[70, 80]]}, "no sample of record bench lies from 70 s to 80 s"),
        ({"step": "mask", "where": {"signal": "force"}}, "give one of below, above, equals; got none"),
        ({"step": "mask", "where": {"signal": "force", "below": 1, "above": 2}}, "got below, above"),
        ({"step": "mask", "where": {"signal": "forse", "below": 0}}, "did you mean 'force'"),
        ({"step": "mask", "where": {"signl": "force", "below": 0}}, "did you mean 'signal'"),
        ({"step": "mask", "stretches": [[0, 1]], "margin": -1}, "margin is -1 s, it must be 0 or more"),
        ({"step": "keep", "stretches": [[0, 0.005]]}, "5 of 2000 samples count, at least 10 are needed"),
    ],
)
def test_wrong_masks_are_told(record_of, values, said):
    with pytest.raises(StepError, match=said) as told:
        apply_steps(record_of(), [values])
    assert "\n" not in str(told.value)


def test_a_part_takes_its_mask_along(record_of):
    record = Mask(stretches=((0.1, 0.2), (0.5, 0.7))).apply(record_of())
    part = Crop(start=0.15, stop=0.6).apply(record)
    assert part.masked == (Masked(0, 50), Masked(350, 450))
    assert record.part(200, 500).masked == ()
    with pytest.raises(RecordError, match="0 of 50 samples count"):
        record.part(120, 170)
    assert np.array_equal(record.with_constants({"J": 1.0}, {"J": "kg"}).counts, record.counts)


def test_decimation_masks_what_its_filter_mixes(record_of):
    record = Mask(stretches=((0.4, 0.5),)).apply(record_of())
    spoiled = record.outputs.copy()
    spoiled[400:500] = 1e3
    thinned = apply_steps(record, [{"step": "decimate", "factor": 10}])
    other = apply_steps(
        type(record)(**{**_fields(record), "outputs": spoiled}), [{"step": "decimate", "factor": 10}]
    )
    assert thinned.masked == (Masked(40, 51),)
    moved = np.abs(thinned.outputs - other.outputs)[:, 0]
    assert moved[thinned.counts].max() < 0.2 * moved.max(), "the main lobe of the filter is masked"


def _fields(record):
    names = (
        "name", "time", "inputs", "outputs", "input_channels", "output_channels", "auxiliary",
        "auxiliary_channels", "masked",
    )  # fmt: skip
    return {name: getattr(record, name) for name in names}


def test_a_file_keeps_the_mask_and_no_mask_adds_nothing(record_of, tmp_path):
    record = Mask(stretches=((0.1, 0.2),), through=False).apply(record_of())
    assert load_record(save_record(record, tmp_path / "a.parquet")).masked == record.masked
    plain = save_record(record_of(), tmp_path / "b.parquet")
    assert b'"masked"' not in plain.read_bytes()


def test_what_does_not_count_is_not_warned_of(record_of):
    flat = record_of(y=lambda t: np.clip(np.sin(9 * t), -0.8, 0.8))
    assert any("clipped" in line for line in flat.warnings)
    masked = apply_steps(
        flat,
        [
            {"step": "mask", "where": {"signal": "position", "above": 0.79}},
            {"step": "mask", "where": {"signal": "position", "below": -0.79}},
        ],
    )
    assert not any("clipped" in line for line in masked.warnings)


def test_a_mean_is_that_of_what_counts(record_of):
    record = record_of(y=lambda t: np.where(t < 1.0, 5.0, 100.0) + 0.1 * np.sin(t))
    masked = Mask(stretches=((1.0, 2.0),)).apply(record)
    kept = apply_steps(masked, [{"step": "remove_mean", "signals": ["position"]}])
    assert abs(kept.counted.mean()) < 1e-12
