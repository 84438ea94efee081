"""The hybrid model that the stage ``residual`` wrote into a run tree, and the report of its training."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from hybridid.hybrid import Hybrid, load_hybrid
from hybridid.hybrid.report import NARXReport, RBFReport
from hybridid.model import Model
from hybridid.residuals.explained import Explained
from pipelines.shared.storage import read_as

FOLDER = "residual"
RESIDUAL = "residual/residual.json"


@dataclass(frozen=True)
class Residual:
    """``model``, the hybrid of a ``case``, fitted to ``records``, and how it came about.

    ``explained`` says of each record how much of the network's output the physical parameters could have
    explained.
    """

    case: str
    model: str
    records: tuple[str, ...]
    provenance: str
    report: NARXReport | RBFReport = field(metadata={"inline": True})
    explained: tuple[Explained, ...]
    warnings: tuple[str, ...]


def residual_of(tree: Path) -> Residual:
    """The report of a run tree, from ``residual/residual.json``."""
    return read_as(Residual, tree / RESIDUAL)


def hybrid_of(tree: Path, model: Model) -> Hybrid | None:
    """The hybrid around the tree's fitted ``model``; None if the tree has no residual network."""
    return load_hybrid(tree / FOLDER, model) if (tree / FOLDER).exists() else None
