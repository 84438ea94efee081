"""Fitting: parameters and initial states from records."""

from hybridid.estimators.estimate import Estimate, EstimatedParameter, Progress
from hybridid.estimators.fit import fit
from hybridid.settings.fit import FitSettings

__all__ = ["Estimate", "EstimatedParameter", "FitSettings", "Progress", "fit"]
