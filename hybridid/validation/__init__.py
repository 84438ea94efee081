"""Validation: predictions in two views, their metrics, and tests of the residual."""

from hybridid.validation.metrics import Metrics, diverged, metrics
from hybridid.validation.predict import VIEWS, Prediction, free_run, horizon_run
from hybridid.validation.residual_tests import ResidualTests, residual_tests

__all__ = [
    "VIEWS",
    "Metrics",
    "Prediction",
    "ResidualTests",
    "diverged",
    "free_run",
    "horizon_run",
    "metrics",
    "residual_tests",
]
