"""What a point's files say of each output: the error on held-out blocks, and those on every record."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pipelines.shared.findings import estimate_of, metric_rows, residual_of
from pipelines.sweep.point import Point


@dataclass(frozen=True)
class Score:
    """RMSE and R² in free run on one record (None: the model ran away); ``fitted`` if it trained on it."""

    record: str
    fitted: bool
    provenance: str
    rmse: float | None
    r2: float | None


@dataclass(frozen=True, eq=False)
class Row:
    """One output of one point, in the output's unit.

    ``held_out`` is the RMSE on the blocks that no fit has seen, ``without`` the gray box' there; None where
    nothing is held out, or the model ran away. ``size`` is what complexity is counted in: weights, or nodes.
    ``merit`` is what the choice goes by, smaller is better, ``near`` up to what it is as good as this one.
    """

    point: Point
    output: str
    unit: str
    scores: tuple[Score, ...]
    size: int = 0
    held_out: float | None = None
    without: float | None = None
    merit: float | None = None
    near: float | None = None

    @property
    def provenance(self) -> str:
        return " and ".join(sorted({score.provenance for score in self.scores}))


def rows_of(point: Point) -> list[Row]:
    """A row for each output of a finished point."""
    return list({"narx": _narx, "rbf": _rbf}.get(str(point.kind), _gray)(point))


def _narx(point: Point) -> Iterator[Row]:
    from hybridid.residuals.choice import NEAR

    for one in residual_of(point.tree)["networks"]:
        yield Row(
            point,
            one["output"],
            one["unit"],
            tuple(_score(row, row["fitted"]) for row in one["hybrid"]),
            one["weights"],
            one["held_out"],
            one["without"],
            one["held_out"],
            None if one["held_out"] is None else NEAR * one["held_out"],
        )


def _rbf(point: Point) -> Iterator[Row]:
    found = residual_of(point.tree)
    (judged,) = found["candidates"]
    for row, (output, unit) in zip(_outputs(judged), _free_runs(point, found["model"]), strict=True):
        held_out, without = row
        merit = judged["score"]
        near = None if merit is None else merit + (judged["standard_error"] or 0.0)
        scores = _scores_of(point, found["model"], output, found["records"])
        yield Row(point, output, unit, scores, judged["nodes"], held_out, without, merit, near)


def _gray(point: Point) -> Iterator[Row]:
    estimate = estimate_of(point.tree)
    for output, unit in _free_runs(point, estimate["model"]):
        yield Row(point, output, unit, _scores_of(point, estimate["model"], output, estimate["records"]))


def _outputs(judged: Mapping[str, Any]) -> list[tuple[float | None, float | None]]:
    return list(zip(judged["rmse"], judged["gray_rmse"], strict=True))


def _free_runs(point: Point, model: str) -> list[tuple[str, str]]:
    """Outputs and their units."""
    rows = [row for row in metric_rows(point.tree) if row["model"] == model]
    return list(dict.fromkeys((row["output"], row["unit"]) for row in rows))


def _scores_of(point: Point, model: str, output: str, fitted: list[str]) -> tuple[Score, ...]:
    rows = [row for row in metric_rows(point.tree) if (row["model"], row["output"]) == (model, output)]
    return tuple(
        _score({**row, "record": row["record"] + _view(row)}, row["record"] in fitted) for row in rows
    )


def _view(row: Mapping[str, Any]) -> str:
    return f", horizon {row['horizon']:g} s" if row["view"] == "horizon" else ""


def _score(row: Mapping[str, Any], fitted: bool) -> Score:
    return Score(row["record"], fitted, row["provenance"], row["rmse"], row["r2"])
