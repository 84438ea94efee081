"""Hybrids: a gray box and a residual model, simulated free-run together."""

from hybridid.hybrid.files import load_hybrid, save_hybrid
from hybridid.hybrid.gray_box import GrayBox, GrayRun, errors_of, gray_runs
from hybridid.hybrid.hybrid import Hybrid
from hybridid.hybrid.output_error import OutputErrorHybrid
from hybridid.hybrid.port import PortHybrid
from hybridid.hybrid.report import FittedHybrid, NARXReport, RBFReport

__all__ = [
    "FittedHybrid",
    "GrayBox",
    "GrayRun",
    "Hybrid",
    "NARXReport",
    "OutputErrorHybrid",
    "PortHybrid",
    "RBFReport",
    "errors_of",
    "gray_runs",
    "load_hybrid",
    "save_hybrid",
]
