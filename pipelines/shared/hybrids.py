"""The hybrid of a run tree, as ``residual`` left it."""

from __future__ import annotations

from pathlib import Path

from hybridid.hybrid import Hybrid, load_hybrid
from hybridid.model import Model

FOLDER = "residual"


def hybrid_of(tree: Path, model: Model) -> Hybrid | None:
    """The hybrid around the tree's fitted ``model``; None if the tree has no residual network."""
    return load_hybrid(tree / FOLDER, model) if (tree / FOLDER).exists() else None
