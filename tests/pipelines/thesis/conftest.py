"""Run trees made up for the tests: small JSON files with numbers that are known."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from pipelines.thesis import chapter4, chapter5, chapter6
from pipelines.thesis.reference import EveryEstimate, NetworkOf, ScoreTable, experiments_of

TABLES = (*chapter4.TABLES, *chapter5.TABLES, *chapter6.TABLES)
EXPERIMENTS = sorted({name for table in TABLES for name in experiments_of(table)})
ROLES = ("identification", "validation")


def provenance(experiment: str) -> str:
    return "measured" if experiment.startswith("emps") else "simulated"


def made_up(root: Path) -> dict[str, Path]:
    """A tree for each experiment; every number in it is another one, from 0.001 on."""
    numbers = (k / 1000 for k in count(1))
    return {name: _tree(root / name, name, numbers) for name in EXPERIMENTS}


def _tree(tree: Path, experiment: str, numbers: Iterator[float]) -> Path:
    data = provenance(experiment)
    records = [{"name": r, "role": r, "provenance": data, "file": f"preprocess/{r}.parquet"} for r in ROLES]
    _write(tree / "preprocess/records.json", records)
    parameters = {
        name: {"value": next(numbers), "std": 0.5, "unit": "N", "at_bound": False, "identifiable": True}
        for name in _parameters(experiment)
    }
    about = {"model": "gray box", "provenance": data, "converged": True, "parameters": parameters}
    _write(tree / "fit/estimate.json", about)
    rows = [
        _scores(numbers, data) | {"model": model, "record": role, "output": output, "view": view}
        for model in ("gray box", "hybrid, a network")
        for role in ROLES
        for output in _outputs(experiment)
        for view in ("free_run", "horizon")
    ]
    _write(tree / "validate/metrics.json", rows)
    report = {"networks": _networks(experiment, numbers, data), **_candidates(), "rule": "the smallest"}
    _write(tree / "residual/residual.json", report)
    return tree


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


def _networks(experiment: str, numbers: Iterator[float], data: str) -> list[dict[str, Any]]:
    """Two seeds of each network of a grid; the second has the lower held-out error."""
    rows = [row.ours for table in chapter4.TABLES if isinstance(table, ScoreTable) for row in table.rows]
    sizes = {(n.depth, n.width) for n in rows if isinstance(n, NetworkOf)}
    return [
        {
            "output": output, "depth": depth, "width": width, "seed": seed, "held_out": 2.0 - seed,
            "chosen": (depth, width, seed) == (3, 8, 1),
            "hybrid": [_scores(numbers, data) | {"record": role} for role in ROLES],
        }
        for output in _outputs(experiment)
        for depth, width in sorted(sizes)
        for seed in (0, 1)
    ]  # fmt: skip


def _candidates() -> dict[str, Any]:
    about = {"gray_rmse": [2e-3], "units": ["m"], "failures": []}
    rows = [{**about, "nodes": n, "rmse": [1e-3 + n * 1e-5]} for n in chapter6.NODES]
    rows[-1] |= {"rmse": [None], "failures": ["a simulation diverges"]}
    return {"candidates": rows, "nodes": 8}


def _scores(numbers: Iterator[float], data: str) -> dict[str, Any]:
    rmse = next(numbers)
    return {"rmse": rmse, "mse": rmse**2, "r2": 1 - rmse, "unit": "m", "provenance": data}


def _write(path: Path, content: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content))


@pytest.fixture
def trees(tmp_path: Path) -> dict[str, Path]:
    """A run tree for each experiment that a table needs, by name."""
    return made_up(tmp_path)
