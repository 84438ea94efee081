"""Hybrids: a gray box and a residual model, simulated free-run together."""

from hybridid.hybrid.files import load_hybrid, save_hybrid
from hybridid.hybrid.hybrid import Hybrid
from hybridid.hybrid.output_error import OutputErrorHybrid
from hybridid.hybrid.port import PortHybrid

__all__ = ["Hybrid", "OutputErrorHybrid", "PortHybrid", "load_hybrid", "save_hybrid"]
