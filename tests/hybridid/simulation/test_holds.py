"""How inputs run between their samples: each hold is what it says, at any length of record."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.record import Channel, Record
from hybridid.simulation.holds import all_held, stage_inputs


def record(*holds: str, n: int = 200, frequency: float = 0.09) -> Record:
    """Inputs of one sine each, ``frequency`` in cycles a sample."""
    time = np.arange(n) * 0.01
    inputs = [np.sin(2 * np.pi * frequency * np.arange(n) + 0.4 + k) for k in range(len(holds))]
    return Record(
        name="sine",
        time=time,
        inputs=np.stack(inputs, axis=1),
        outputs=time[:, None] ** 2,
        input_channels=tuple(Channel(f"u{k}", "V", hold) for k, hold in enumerate(holds)),
        output_channels=(Channel("y", "m"),),
    )


def fine_sine(n: int, stages: int, frequency: float = 0.09) -> np.ndarray:
    at = np.arange(n)[:, None] + np.linspace(0, 1, stages + 1)
    return np.sin(2 * np.pi * frequency * at + 0.4)


def test_held_inputs_are_their_samples():
    made = record("zoh", "zoh")
    assert all_held(made)
    np.testing.assert_array_equal(stage_inputs(made, 3), made.inputs)


def test_linear_inputs_meet_in_the_samples():
    made = record("foh")
    stages = stage_inputs(made, 2)
    assert stages.shape == (200, 5)
    np.testing.assert_array_equal(stages[:, 0], made.inputs[:, 0])
    np.testing.assert_array_equal(stages[:-1, 4], made.inputs[1:, 0])
    np.testing.assert_allclose(stages[:-1, 2], 0.5 * (made.inputs[:-1, 0] + made.inputs[1:, 0]), atol=1e-15)
    np.testing.assert_array_equal(stages[-1], np.full(5, made.inputs[-1, 0]))


@pytest.mark.parametrize(("hold", "worst"), [("zoh", 0.6), ("foh", 0.045), ("bandlimited", 2e-5)])
def test_a_measured_sine_is_restored_best_by_the_band_limited_hold(hold, worst):
    """Eleven samples a period, away from the ends: errors fall by the smoothness assumed."""
    made = record(hold, "foh")
    inner = stage_inputs(made, 2).reshape(200, 5, 2)[50:150, :, 0]
    error = np.abs(inner - fine_sine(200, 4)[50:150]).max()
    assert worst / 3 < error <= worst


@pytest.mark.parametrize("n", [10, 11, 32, 33, 64, 65, 200, 201])
def test_band_limited_records_of_any_length_are_restored_up_to_their_ends(n):
    made = record("bandlimited", n=n, frequency=0.05)
    stages = stage_inputs(made, 2)
    assert stages.shape == (n, 5)
    error = np.abs(stages[:-1] - fine_sine(n, 4, 0.05)[:-1])
    assert error.max() < 0.02, "the ends are continued, not cut"
    np.testing.assert_allclose(stages[:, 0], made.inputs[:, 0], atol=3e-5)
    np.testing.assert_allclose(stages[:-1, 4], made.inputs[1:, 0], atol=3e-5)
    np.testing.assert_allclose(stages[-1], made.inputs[-1, 0], atol=3e-5)


def test_each_input_keeps_its_own_hold():
    made = record("zoh", "foh", "bandlimited")
    assert not all_held(made)
    stages = stage_inputs(made, 1).reshape(200, 3, 3)
    np.testing.assert_array_equal(stages[:, 2, 0], made.inputs[:, 0])
    np.testing.assert_array_equal(stages[:-1, 2, 1], made.inputs[1:, 1])
    alone = Record(
        "alone", made.time, made.inputs[:, 2:], made.outputs, made.input_channels[2:], made.output_channels
    )
    np.testing.assert_allclose(stages[:, :, 2], stage_inputs(alone, 1), atol=1e-14)


@pytest.mark.parametrize(("start", "stop"), [(0, 5), (3, 90), (60, 61), (150, 200), (0, 200)])
def test_a_part_of_a_record_has_the_inputs_of_the_whole(start, stop):
    one = record("bandlimited", "foh", "zoh")
    np.testing.assert_array_equal(stage_inputs(one, 3, start, stop), stage_inputs(one, 3)[start:stop])
