"""The level of a law of two variables, drawn over the freed amplitude that it explains."""

from __future__ import annotations

import numpy as np

from hybridid.effects.composed import ComposedLaw
from hybridid.trace.horizons.split import Split
from hybridid.trace.laws.level_starts import freed_path
from hybridid.trace.learned.law_curve import LawCurve, LawOverLearned, binned
from hybridid.trace.learned.varying import Varied
from hybridid.trace.trials.trial import Trial


def level_over_freed(law: Trial, of: Trial, freed: Varied, split: Split) -> LawOverLearned:
    """The level of ``law``, and the ``freed`` amplitude of the law ``of`` one variable.

    Both are over the law with its amplitude as a constant, so they are numbers. The level is shown where it
    comes nearest.
    """
    composed = law.candidate.effect.law
    assert isinstance(composed, ComposedLaw)
    assert composed.level is not None
    along = freed_path(of.candidate, freed, split)
    learned = binned(along.y, along.freed, along.constant)
    values = law.own("values")
    level = composed.level.shape.values(learned.at, values)
    scale = float(np.sum(level * learned.value) / np.sum(level**2))
    port = law.candidate.port
    at = of.refit.model.plant.port(port) if of.refit else None
    assert at is not None
    return LawOverLearned(
        port,
        composed.level.over,
        "1",
        composed.level.over.dimension.unit(at),
        LawCurve(learned.at, scale * level, learned.samples),
        learned,
        value="amplitude",
    )
