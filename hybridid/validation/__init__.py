"""Validation: predictions in three views, their metrics, and tests of the residual."""

from hybridid.validation.in_loop import (
    Agreement,
    agreement,
    disagreement,
    in_loop,
    synchronised,
    unknown_agreement,
)
from hybridid.validation.metrics import Metrics, diverged, metrics
from hybridid.validation.predict import VIEWS, Prediction, free_run, horizon_run
from hybridid.validation.residual_tests import ResidualTests, residual_tests

__all__ = [
    "VIEWS",
    "Agreement",
    "Metrics",
    "Prediction",
    "ResidualTests",
    "agreement",
    "disagreement",
    "diverged",
    "free_run",
    "horizon_run",
    "in_loop",
    "metrics",
    "residual_tests",
    "synchronised",
    "unknown_agreement",
]
