"""Cells of one output that were not measured, on a simulated sledge of two sensors: the other one counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.plotting.series import Response
from hybridid.records.channel import RecordError
from hybridid.records.sensor_noise import noise_level
from hybridid.residuals.series import error_series
from hybridid.simulation.windows import cut
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import by_blocks, check_measured
from hybridid.trace.refits.refit import refit
from hybridid.validation import free_run, horizon_run, metrics, residual_tests

N, TRUTH = 1200, {"M": 2.0, "d": 3.0}
NOISE = np.array([2e-3, 1e-2])  # m, m/s


@pytest.fixture(scope="module")
def record(sledge_record):
    return sledge_record(NOISE)


@pytest.fixture(scope="module")
def holes():
    """The speed drops out for a second now and then, the position at single samples."""
    cells = np.zeros((N, 2), dtype=bool)
    for start in range(150, N, 300):
        cells[start : start + 100, 1] = True
    cells[np.random.default_rng(1).integers(0, N, 100), 0] = True
    return cells & ~cells.all(axis=1, keepdims=True)


@pytest.fixture(scope="module")
def with_value(record, holes):
    """The record whose cells there hold ``value``, and do not count if ``absent``."""

    def made(value, absent=True):
        outputs = np.where(holes, value, record.outputs)
        return replace(record, outputs=outputs, absent=holes if absent else None, warnings=())

    return made


SETTINGS = {
    "free run": FitSettings(),
    "horizons": FitSettings(horizon=100),
    "multiple shooting": FitSettings(method="multiple_shooting", interval=50),
    "Huber": FitSettings(loss="huber"),
}


@pytest.mark.parametrize("kind", SETTINGS)
def test_what_stands_in_an_absent_cell_moves_nothing(sledge, with_value, kind):
    ours, other = (fit(sledge, [with_value(value)], SETTINGS[kind]) for value in (0.0, 0.7))
    for one, also in zip(ours.parameters, other.parameters, strict=True):
        assert one.value == pytest.approx(also.value, abs=0.01 * one.std)
        assert one.std == pytest.approx(also.std, rel=1e-3)
        assert abs(one.value - TRUTH[one.name]) < 4 * one.std
    spoiled = fit(sledge, [with_value(0.7, absent=False)])
    assert max(abs(spoiled.values[name] - TRUTH[name]) / TRUTH[name] for name in TRUTH) > 0.05


def test_the_other_output_counts_where_one_is_absent(sledge, record):
    """Each sample shows one output, a random one: half of the cells, and √2 of the standard errors."""
    first = np.random.default_rng(2).random(N) < 0.5
    cells = np.column_stack([first, ~first])
    half = fit(sledge, [replace(record, absent=cells)])
    whole = fit(sledge, [record])
    for one, also in zip(half.parameters, whole.parameters, strict=True):
        assert one.std / also.std == pytest.approx(np.sqrt(2), rel=0.1)


def test_scores_and_tests_see_what_was_measured_alone(sledge, with_value, holes):
    spoiled = with_value(50.0)
    for run in (free_run(sledge, TRUTH, spoiled), horizon_run(sledge, TRUTH, spoiled, 100)):
        rows = metrics(run, "sledge")
        assert [row.n for row in rows] == (~holes).sum(axis=0).tolist()
        assert [row.rmse for row in rows] == pytest.approx(NOISE, rel=0.1)
        tests = residual_tests(run, spoiled)
        assert all(np.isfinite(one.autocorrelation).all() for one in tests)
        for k, name in enumerate(run.output_names):
            drawn = Response.of("sledge", run, name)
            assert len(drawn.time) == (~holes[:, k]).sum()
            assert np.abs(drawn.error).max() < 6 * NOISE[k]
    assert noise_level(spoiled) == pytest.approx(NOISE, rel=0.3)


def test_a_refit_of_a_trace_counts_what_was_measured(sledge, with_value, holes):
    """Its score holds all cells that were measured, and none of what stands in the place of the others."""
    straight, spoiled = (refit(sledge, by_blocks([with_value(value)], 100)) for value in (0.0, 50.0))
    judged = np.concatenate([holes[k : k + 90] for k in range(100, N, 200)])  # a tenth is the gap
    assert spoiled.score.samples.sum(axis=0).tolist() == (~judged).sum(axis=0).tolist()
    assert spoiled.score.rmse == pytest.approx(NOISE, rel=0.15)
    assert spoiled.score.rmse == pytest.approx(straight.score.rmse, rel=1e-3)
    assert spoiled.fitted_rmse == pytest.approx(straight.fitted_rmse, rel=1e-3)
    assert compare(spoiled.score, straight.score).p_value > 0.05


def test_an_output_that_no_horizon_holds_is_told(record):
    cells = np.zeros((N, 2), dtype=bool)
    cells[:, 1] = np.arange(N) // 100 % 2 == 1
    split = by_blocks([replace(record, absent=cells)], 100)
    with pytest.raises(ValueError, match="output speed in at least 4 of the 6 horizons held out, and it was"):
        check_measured(split)
    check_measured(by_blocks([record], 100))


def test_a_sample_without_any_output_is_masked(record):
    cells = np.zeros((N, 2), dtype=bool)
    cells[30:40] = True
    cells[100:120, 1] = True
    found = replace(record, absent=cells)
    assert [tuple(one) for one in found.masked] == [(30, 40, True)]
    assert found.absent.sum(axis=0).tolist() == [0, 20]
    windows = cut([found], None, 1)
    assert windows.samples == N - 10
    assert windows.counts.tolist() == [N - 10, N - 30]
    assert found.part(90, 200).absent.sum(axis=0).tolist() == [0, 20]


def test_too_few_cells_are_refused(record):
    cells = np.zeros((N, 2), dtype=bool)
    cells[5:, 1] = True
    with pytest.raises(RecordError, match=r"output 'speed' counts at 5 of 1200 samples, at least 10"):
        replace(record, absent=cells)


def test_the_errors_of_a_network_are_those_that_were_measured(sledge, with_value, holes):
    spoiled = with_value(50.0)
    found = error_series(free_run(sledge, TRUTH, spoiled), spoiled, "speed")
    assert np.array_equal(np.isnan(found.error), holes[:, 1])
    assert np.nanmax(np.abs(found.error)) < 6 * NOISE[1]


def test_a_network_that_runs_through_whole_records_refuses_a_mask(sledge, record):
    cells = np.zeros((N, 2), dtype=bool)
    cells[100:140] = True
    masked = replace(record, absent=cells)
    with pytest.raises(
        RecordError, match=r"masked, first from t = 1 s to 1.39 s: residual=narx runs through"
    ):
        error_series(free_run(sledge, TRUTH, masked), masked, "speed")
