"""The tables of the thesis as data: each printed number, and where to find ours in the run trees.

Source: PUC-Rio thesis (2023), Tables 4.2 to 6.4. ``care`` are the errata of a table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Measure = Literal["rmse", "mse"]


@dataclass(frozen=True)
class ParameterOf:
    """Our estimate of a parameter in an experiment."""

    experiment: str
    name: str


@dataclass(frozen=True)
class ScoreOf:
    """Our score in an experiment: of the record with ``role``, of the gray box or of the hybrid."""

    experiment: str
    role: str
    output: str
    of: Literal["gray box", "hybrid"] = "gray box"
    view: str = "free_run"


@dataclass(frozen=True)
class NetworkOf:
    """Our score of one network of a grid: the hybrid of this ``depth`` and ``width`` in free run."""

    experiment: str
    role: str
    output: str
    depth: int
    width: int


@dataclass(frozen=True)
class Estimates:
    """A row of estimates: the thesis' value (None: it prints none) and ours."""

    label: str
    thesis: float | None
    ours: ParameterOf


@dataclass(frozen=True)
class EveryEstimate:
    """A row for each parameter that ``experiment`` estimated; the thesis' values are not legible."""

    label: str
    experiment: str


@dataclass(frozen=True)
class Printed:
    """The error and R² of a model as the thesis printed them, with the printed reduction in %."""

    error: float
    r2: float
    reduction: float | None = None


@dataclass(frozen=True)
class Scores:
    """A row of scores. ``against`` is the label of the row that its reduction refers to; "" for none."""

    label: str
    thesis: Printed | None
    ours: ScoreOf | NetworkOf
    against: str = ""


@dataclass(frozen=True)
class EstimateTable:
    """A table of estimates."""

    number: str
    title: str
    rows: tuple[Estimates | EveryEstimate, ...]
    care: tuple[str, ...] = ()


@dataclass(frozen=True)
class ScoreTable:
    """A table of errors and R². An error in SI units, times ``factor``, is an error in ``unit``."""

    number: str
    title: str
    measure: Measure
    unit: str
    rows: tuple[Scores, ...]
    care: tuple[str, ...] = ()
    factor: float = 1.0


ThesisTable = EstimateTable | ScoreTable


def experiments_of(table: ThesisTable) -> set[str]:
    """The experiments that a table's numbers come from."""
    if isinstance(table, ScoreTable):
        return {row.ours.experiment for row in table.rows}
    return {row.experiment if isinstance(row, EveryEstimate) else row.ours.experiment for row in table.rows}
