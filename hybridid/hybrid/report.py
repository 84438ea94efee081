"""How a hybrid came about, in numbers: what ``residual.json`` holds. Errors are in each output's SI unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hybridid.estimators.estimate import Estimate
from hybridid.hybrid.hybrid import Hybrid
from hybridid.residuals.settings import Epoch


@dataclass(frozen=True)
class RecordScore:
    """One output of one record in free run, in SI units; ``fitted``: the network is fitted to that record.

    Scores are nan where the model diverged; then ``remark`` says so.
    """

    record: str
    fitted: bool
    provenance: str
    output: str
    mse: float
    rmse: float
    r2: float
    n: int
    unit: str
    remark: str = ""


@dataclass(frozen=True)
class NetworkScore:
    """A NARX network of a grid: its RMSE on the held-out blocks, and ``without`` it that of the gray box.

    It is the mean of ``members`` networks; ``weights`` counts those of each. ``stopped`` says why the
    training on each horizon ended, ``chosen`` whether the rule took this network. ``hybrid`` are the scores
    of the gray box with this network, record by record.
    """

    output: str
    depth: int
    width: int
    seed: int
    weights: int
    held_out: float
    without: float
    unit: str
    stopped: tuple[str, ...]
    chosen: bool
    hybrid: tuple[RecordScore, ...]
    members: int = 1


@dataclass(frozen=True)
class NARXReport:
    """A grid of NARX networks, the scores of the ``gray`` box alone, and the ``rule`` of choice.

    ``history`` is the training of the chosen network of each output; ``seconds`` that of all networks.
    """

    networks: tuple[NetworkScore, ...]
    gray: tuple[RecordScore, ...]
    rule: str
    history: Mapping[str, tuple[Epoch, ...]]
    seconds: float


@dataclass(frozen=True)
class CandidateScore:
    """Radial basis functions with so many ``nodes``, fitted over a ``horizon`` (samples; None: the record).

    ``rmse`` on the held-out blocks, ``gray_rmse`` that of the gray box, by output in ``units``; nan where a
    fit failed, and ``failures`` say why. ``score`` is the mean square over the outputs' variances, with its
    ``standard_error`` over the folds.
    """

    nodes: int
    horizon: int | None
    rmse: tuple[float, ...]
    gray_rmse: tuple[float, ...]
    units: tuple[str, ...]
    score: float
    standard_error: float
    failures: tuple[str, ...]
    chosen: bool


@dataclass(frozen=True)
class RBFReport:
    """The radial basis functions kept: ``nodes``, the ``horizon`` fitted over (samples; None: the record),
    and how the ``physics`` took part. ``candidates`` were compared by the ``rule``; there are none, and no
    rule, if there was one to fit alone."""

    nodes: int
    horizon: int | None
    physics: str
    candidates: tuple[CandidateScore, ...]
    rule: str | None
    seconds: float


@dataclass(frozen=True, eq=False)
class FittedHybrid:
    """A hybrid, how it came about, and what a reader must know.

    ``estimate`` are its parameters where the network stands inside the equations.
    """

    hybrid: Hybrid
    report: NARXReport | RBFReport
    warnings: tuple[str, ...]
    estimate: Estimate | None = None
