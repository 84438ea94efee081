"""What a run tree says: read from its files, for the terminal and for MLflow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hybridid.estimators.estimate import Estimate
from hybridid.trace.result import Trace
from pipelines.shared.storage import read_json
from pipelines.shared.traced import TRACE, trace_of

RECORDS = "preprocess/records.json"
ESTIMATE = "fit/estimate.json"
METRICS = "validate/metrics.json"
RESIDUAL = "residual/residual.json"


@dataclass(frozen=True)
class Prepared:
    """A record that ``preprocess`` left: ``file`` lies in the tree, ``row`` is all that it wrote of it."""

    name: str
    role: str
    provenance: str
    file: Path
    row: Mapping[str, Any]


def prepared_records(tree: Path) -> list[Prepared]:
    """The records of ``preprocess/records.json``."""
    return [
        Prepared(r["name"], r["role"], r["provenance"], tree / r["file"], r)
        for r in read_json(tree / RECORDS)
    ]


def estimate_of(tree: Path) -> dict[str, Any]:
    """``fit/estimate.json``."""
    return dict(read_json(tree / ESTIMATE))


def metric_rows(tree: Path) -> list[dict[str, Any]]:
    """``validate/metrics.json``: rows of model, record, output, view, mse, rmse, r2, n."""
    return list(read_json(tree / METRICS))


def loaded_estimate(tree: Path) -> Estimate:
    """The estimate as the fit left it; JSON's null is what is not finite."""
    data = estimate_of(tree)
    nan, inf = float("nan"), float("inf")
    for parameter in data["parameters"].values():
        instead = {"lower": -inf, "upper": inf, "std": nan, "value": nan}
        parameter.update({key: instead[key] for key in instead if parameter[key] is None})
    numbers = {key: [nan if v is None else v for v in data[key]] for key in ("history", "starts")}
    matrices = {
        k: [[nan if v is None else v for v in row] for row in data[k]]
        for k in ("correlation", "initial_states")
    }
    cost = nan if data["cost"] is None else data["cost"]
    estimate = Estimate.from_dict({**data, **numbers, **matrices, "cost": cost})
    return replace(estimate, seconds={k: float(v) for k, v in estimate.seconds.items()})


def residual_of(tree: Path) -> dict[str, Any]:
    """``residual/residual.json``: how the network came about, and how much physics could have explained."""
    return dict(read_json(tree / RESIDUAL))


def provenance_of(tree: Path) -> str:
    """``measured``, ``simulated``, or both."""
    return " and ".join(sorted({record.provenance for record in prepared_records(tree)}))


def metrics_of(tree: Path, stages: Sequence[str]) -> dict[str, float]:
    """Every finite number found by ``stages``, by a name that says what it is."""
    found: dict[str, float | None] = {}
    if "fit" in stages:
        estimate = estimate_of(tree)
        found |= {"fit.cost": estimate["cost"], "fit.iterations": estimate["iterations"]}
        found |= {f"fit.seconds.{name}": value for name, value in estimate["seconds"].items()}
        for name, parameter in estimate["parameters"].items():
            found |= {f"parameter.{name}": parameter["value"], f"std.{name}": parameter["std"]}
    if "validate" in stages:
        gray = estimate_of(tree)["model"]
        for row in metric_rows(tree):
            where = f"{row['record']}.{row['output']}.{row['view']}"
            where = where if row["model"] == gray else f"hybrid.{where}"
            found |= {f"{where}.{score}": row[score] for score in ("mse", "rmse", "r2", "fit_percent")}
    if "residual" in stages:
        found |= _residual_metrics(residual_of(tree))
    if "trace" in stages:
        found |= _trace_metrics(trace_of(tree).found)
    return {name: float(value) for name, value in found.items() if value is not None and math.isfinite(value)}


def _residual_metrics(data: Mapping[str, Any]) -> dict[str, float | None]:
    """Each network's held-out error, and how much of the network physics could have explained."""
    found: dict[str, float | None] = {"residual.seconds": data["seconds"]}
    for row in data["explained"]:
        found[f"residual.explained.{row['record']}"] = row["share"]
    for row in data.get("networks", ()):
        size = f"{row['depth']}x{row['width']}"
        found[f"residual.held_out.{row['output']}.{size}.seed_{row['seed']}"] = row["held_out"]
    for row in data.get("candidates", ()):
        horizon = "record" if row["horizon"] is None else row["horizon"]
        found[f"residual.score.nodes_{row['nodes']}.horizon_{horizon}"] = row["score"]
    return found


def _trace_metrics(found: Trace) -> dict[str, float | None]:
    """Errors before and after, and each accepted effect's gain, p-value and parameters."""
    numbers: dict[str, float | None] = {
        "trace.seconds": found.seconds,
        "trace.accepted": float(len(found.accepted)),
    }
    for when, rows in (("before", found.before), ("after", found.after)):
        for row in rows:
            where = f"trace.{when}.{row.record}.{row.output}.{row.view}"
            numbers |= {f"{where}.mse": row.mse, f"{where}.rmse": row.rmse, f"{where}.r2": row.r2}
    for entry in found.accepted:
        name = f"trace.{entry.name}"
        numbers |= {f"{name}.gain": entry.gain, f"{name}.p_value": entry.p_value}
        numbers |= {f"{name}.{p}": parameter.value for p, parameter in entry.parameters.items()}
    return numbers


def cost_history(tree: Path) -> list[float]:
    """The cost after each iteration of the fit."""
    return [float(cost) for cost in estimate_of(tree)["history"] if cost is not None]


def facts(tree: Path) -> dict[str, str]:
    """What identifies a run beside its config: digests of its data, status of its fit."""
    said = {f"data.{record.name}": str(record.row["digest"]) for record in prepared_records(tree)}
    if (tree / ESTIMATE).exists():
        estimate = estimate_of(tree)
        said |= {"fit.status": str(estimate["status"]), "fit.converged": str(estimate["converged"]).lower()}
    if (tree / TRACE).exists():
        said["trace.verdict"] = trace_of(tree).found.verdict
    return said
