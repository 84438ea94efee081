"""Run trees made up for the tests: small JSON files with numbers that are known."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hybridid.estimators import Estimate, EstimatedParameter, FitSettings
from hybridid.hybrid.report import CandidateScore, NARXReport, NetworkScore, RBFReport, RecordScore
from hybridid.quality import Quality
from hybridid.validation import Metrics
from pipelines.shared.fitted import Fit
from pipelines.shared.hybrids import Residual
from pipelines.shared.prepared import Prepared
from pipelines.shared.storage import write_json
from pipelines.thesis import chapter4, chapter5, chapter6
from pipelines.thesis.reference import EveryEstimate, NetworkOf, ScoreTable, experiments_of

TABLES = (*chapter4.TABLES, *chapter5.TABLES, *chapter6.TABLES)
EXPERIMENTS = sorted({name for table in TABLES for name in experiments_of(table)})
INF = float("inf")
ROLES = ("identification", "validation")


def provenance(experiment: str) -> str:
    return "measured" if experiment.startswith("emps") else "simulated"


def made_up(root: Path) -> dict[str, Path]:
    """A tree for each experiment; every number in it is another one, from 0.001 on."""
    numbers = (k / 1000 for k in count(1))
    return {name: _tree(root / name, name, numbers) for name in EXPERIMENTS}


def _tree(tree: Path, experiment: str, numbers: Iterator[float]) -> Path:
    data = provenance(experiment)
    _write(tree / "preprocess/records.json", [_prepared(role, data) for role in ROLES])
    parameters = tuple(
        EstimatedParameter(name, next(numbers), 0.5, "N", -INF, INF, at_bound=False, identifiable=True)
        for name in _parameters(experiment)
    )
    quality = Quality("sound", "sound", (), (), 0.0)
    fit = Fit("", "gray box", ("identification",), data, (), quality, _estimate(parameters))
    _write(tree / "fit/estimate.json", fit)
    rows = [
        _metrics(next(numbers), data, model, role, output, view)
        for model in ("gray box", "hybrid, a network")
        for role in ROLES
        for output in _outputs(experiment)
        for view in ("free_run", "horizon")
    ]
    _write(tree / "validate/metrics.json", rows)
    report = _candidates() if experiment == chapter6.CHOSEN else _networks(experiment, numbers, data)
    _write(tree / "residual/residual.json", Residual(experiment, "", (), data, report, (), ()))
    return tree


def _prepared(role: str, data: str) -> Prepared:
    return Prepared(role, role, data, Path(f"preprocess/{role}.parquet"), "", "", 10, 0.1, (), (), (), ())


def _estimate(parameters: tuple[EstimatedParameter, ...]) -> Estimate:
    nothing = np.zeros((0, 0))
    return Estimate(
        parameters, {}, nothing, nothing, (), 1.0, "converged", converged=True, iterations=3,
        seconds={"build": 0.1, "solve": 0.2}, substeps=1, settings=FitSettings(),
    )  # fmt: skip


def _parameters(experiment: str) -> list[str]:
    rows = [row for table in TABLES if not isinstance(table, ScoreTable) for row in table.rows]
    found = [
        row.ours.name
        for row in rows
        if not isinstance(row, EveryEstimate) and row.ours.experiment == experiment
    ]
    return found or ["motor.viscous.f_v"]


def _outputs(experiment: str) -> list[str]:
    rows = [row for table in TABLES if isinstance(table, ScoreTable) for row in table.rows]
    return sorted({row.ours.output for row in rows if row.ours.experiment == experiment})


def _networks(experiment: str, numbers: Iterator[float], data: str) -> NARXReport:
    """Two seeds of each network of a grid; the second has the lower held-out error."""
    rows = [row.ours for table in chapter4.TABLES if isinstance(table, ScoreTable) for row in table.rows]
    sizes = {(n.depth, n.width) for n in rows if isinstance(n, NetworkOf)}
    networks = tuple(
        NetworkScore(
            output, depth, width, seed, 10, held_out=2.0 - seed, without=3.0, unit="m", stopped=(),
            chosen=(depth, width, seed) == (3, 8, 1),
            hybrid=tuple(_score(next(numbers), data, role, output) for role in ROLES),
        )
        for output in _outputs(experiment)
        for depth, width in sorted(sizes)
        for seed in (0, 1)
    )  # fmt: skip
    return NARXReport(networks, (), "the smallest", {}, 1.0)


def _candidates() -> RBFReport:
    rows = [_candidate(n, 1e-3 + n * 1e-5) for n in chapter6.NODES]
    rows[-1] = replace(rows[-1], rmse=(INF,), failures=("a simulation diverges",))
    return RBFReport(8, None, "refitted", tuple(rows), "the smallest", 1.0)


def _candidate(nodes: int, rmse: float) -> CandidateScore:
    return CandidateScore(nodes, None, (rmse,), (2e-3,), ("m",), 1.0, 0.1, (), chosen=nodes == 8)


def _metrics(rmse: float, data: str, model: str, role: str, output: str, view: str) -> Metrics:
    horizon = None if view == "free_run" else 1.0
    return Metrics(
        model, role, output, view, rmse**2, rmse, 1 - rmse, 90.0, 10, "m", data, horizon, mae=0.8 * rmse
    )


def _score(rmse: float, data: str, role: str, output: str) -> RecordScore:
    return RecordScore(role, role == "identification", data, output, rmse**2, rmse, 1 - rmse, 10, "m")


def _write(path: Path, content: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_json(path, content)


@pytest.fixture
def trees(tmp_path: Path) -> dict[str, Path]:
    """A run tree for each experiment that a table needs, by name."""
    return made_up(tmp_path)
