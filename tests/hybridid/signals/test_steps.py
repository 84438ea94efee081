"""Steps come from plain mappings, are done in order, and say what is wrong with them in one line."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hybridid.records.channel import Channel
from hybridid.signals.butterworth import Butterworth
from hybridid.signals.step import StepError
from hybridid.signals.steps import STEPS, apply_steps, parse_step, parse_steps

EXAMPLES = {
    "butterworth": {"signals": ["position"], "order": 4, "cutoff": 50.0, "zero_phase": True},
    "crop": {"start": 0.2, "stop": 1.5},
    "decimate": {"factor": 2},
    "differentiate": {"signal": "position", "name": "v", "unit": "m/s", "cutoff": 20},
    "integrate": {"signal": "position", "name": "s", "unit": "m·s", "drift": "linear"},
    "keep": {"where": {"signal": "force", "below": 0.5}, "through": False},
    "mask": {"stretches": [[0.2, 0.3], [1, 1.5]], "margin": 0.01},
    "offset": {"signals": "position", "value": 0.1},
    "remove_mean": {"signals": ["position", "force"], "over": [0, 1]},
    "savitzky_golay": {"signal": "position", "window": 11},
    "scale": {"signals": ["position"], "factor": 1000, "unit": "mm"},
}


def test_every_step_is_exemplified():
    assert EXAMPLES.keys() == STEPS.keys()


@pytest.mark.parametrize("name", STEPS)
def test_every_step_is_read_and_leaves_its_record_alone(record_of, name):
    record = record_of(y=lambda t: np.sin(9 * t), u=lambda t: np.cos(11 * t))
    before = (record.time.copy(), record.inputs.copy(), record.outputs.copy(), record.auxiliary.copy())
    step = parse_step({"step": name, **EXAMPLES[name]})
    assert type(step) is STEPS[name]
    assert dataclasses.is_dataclass(step)
    after = step.apply(record)
    assert after is not record
    assert (after.n, after.outputs.shape, after.outputs.tobytes(), after.masked) != (
        record.n,
        record.outputs.shape,
        record.outputs.tobytes(),
        (),
    )
    for kept, array in zip(
        before, (record.time, record.inputs, record.outputs, record.auxiliary), strict=True
    ):
        assert np.array_equal(kept, array)
    assert after.digest == record.digest
    assert after.provenance == record.provenance


def test_steps_are_done_in_order(record_of):
    shift, scale = (
        {"step": "offset", "signals": "position", "value": 1.0},
        EXAMPLES["scale"] | {"step": "scale"},
    )
    record = record_of()
    y = record.output("position")
    np.testing.assert_allclose(apply_steps(record, [shift, scale]).output("position"), 1000 * (y + 1))
    np.testing.assert_allclose(apply_steps(record, [scale, shift]).output("position"), 1000 * y + 1)
    assert apply_steps(record, []) is record


def test_a_step_may_use_what_an_earlier_one_made(record_of):
    steps = [
        {"step": "integrate", "signal": "position", "name": "s", "unit": "m·s"},
        {"step": "remove_mean", "signals": ["s"]},
    ]
    assert abs(apply_steps(record_of(), steps).output("s").mean()) < 1e-12


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"step": "buterworth"}, "step 1: unknown step 'buterworth': did you mean 'butterworth'? allowed: "),
        ({"signals": ["position"]}, "step 1: key 'step' is missing"),
        (
            {"step": "butterworth", "signals": "position", "cutof": 5},
            "step 1 (butterworth): unknown key 'cutof': did",
        ),
        ({"step": "butterworth", "signals": "position"}, "step 1 (butterworth): key 'cutoff' is missing"),
        (
            {"step": "butterworth", "signals": "position", "cutoff": "5"},
            "step 1 (butterworth): cutoff is '5': exp",
        ),
        (
            {"step": "butterworth", "signals": "position", "cutoff": -5.0},
            "step 1 (butterworth): cutoff -5.0 Hz must",
        ),
        (
            {"step": "butterworth", "signals": "position", "cutoff": 501},
            "step 1 (butterworth): cutoff is 501 Hz, it",
        ),
        (
            {"step": "offset", "signals": "psition", "value": 1},
            "step 1 (offset): record bench: unknown signal 'psit",
        ),
        ({"step": "crop", "samples": [0, 5]}, "step 1 (crop): record bench: 5 samples are too few"),
    ],
)
def test_a_wrong_step_is_one_line(record_of, values, said):
    with pytest.raises(StepError) as caught:
        apply_steps(record_of(), [values])
    assert str(caught.value).startswith(said)
    assert "\n" not in str(caught.value)


def test_parse_steps_counts():
    with pytest.raises(StepError, match="preprocess step 2: unknown step 'scael': did you mean 'scale'"):
        parse_steps([{"step": "offset", "signals": "x", "value": 1}, {"step": "scael"}], "preprocess step")


def causal(*signals: str, cutoff: float = 50.0) -> dict:
    return {"step": "butterworth", "signals": list(signals), "cutoff": cutoff, "zero_phase": False}


def test_outputs_filtered_alone_and_causally_are_warned_of(record_of):
    (warning,) = apply_steps(record_of(), [causal("position")]).warnings
    assert "output 'position' passed a causal low-pass of order 4 at 50 Hz, 8.32 ms" in warning
    assert "input 'force' did not" in warning


@pytest.mark.parametrize(
    "steps",
    [
        [causal("position", "force")],
        [causal("position"), causal("force")],
        [causal("force"), causal("position")],
        [causal("force")],
        [causal("reference")],
        [{**causal("position"), "zero_phase": True}],
    ],
)
def test_alike_or_without_lag_there_is_no_warning(record_of, steps):
    assert apply_steps(record_of(), steps).warnings == ()


def test_alike_means_the_same_filter_as_often(record_of):
    assert len(apply_steps(record_of(), [causal("position"), causal("force", cutoff=60.0)]).warnings) == 1
    assert len(apply_steps(record_of(), [causal("position", "force"), causal("position")]).warnings) == 1


def test_a_signal_made_from_a_lagging_one_lags(record_of):
    steps = [
        causal("reference"),
        {"step": "integrate", "signal": "reference", "name": "s", "unit": "m·s"},
    ]
    (warning,) = apply_steps(record_of(), steps).warnings
    assert "output 's' passed a causal" in warning


def test_ready_made_steps_are_taken_too(record_of):
    record = record_of(y=lambda t: np.sin(900 * t))
    assert np.ptp(apply_steps(record, [Butterworth(("position",), 5.0)]).output("position")[500:1500]) < 1e-3


def test_absent_cells_go_along_with_their_output(record_of):
    """A derivative is missing where its source is; a demoted source takes its cells along."""
    record = record_of(y=lambda t: np.sin(9 * t))
    gone = np.zeros((record.n, 1), dtype=bool)
    gone[300:340] = True
    double = dataclasses.replace(
        record,
        outputs=np.hstack([record.outputs, record.outputs]),
        output_channels=(*record.output_channels, Channel("other", "m")),
        absent=np.hstack([gone, ~gone & False]),
    )
    derive = {"step": "differentiate", "signal": "position", "name": "v", "unit": "m/s", "cutoff": 20}
    made = apply_steps(double, [derive])
    assert made.absent.sum(axis=0).tolist() == [40, 0, 40]
    demoted = apply_steps(double, [{**derive, "demote": True}])
    assert [channel.name for channel in demoted.output_channels] == ["v", "other"]
    assert demoted.absent.sum(axis=0).tolist() == [40, 0]
    fewer = apply_steps(double, [{"step": "decimate", "factor": 4}])
    assert fewer.absent.sum(axis=0).tolist() == [11, 0]  # with those that the filter mixes most
    assert apply_steps(double, [{"step": "crop", "start": 0.32}]).absent.sum() == 20
