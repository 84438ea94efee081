"""Fit quality: what a fit leaves, beside noise and doing nothing, and whether the model is wrong."""

from hybridid.quality.judge import judge
from hybridid.quality.verdict import Finding, Quality, Verdict, View

__all__ = ["Finding", "Quality", "Verdict", "View", "judge"]
