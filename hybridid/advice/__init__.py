"""Advice after a fit: what an experienced colleague would say of records, horizons and bounds."""

from hybridid.advice.advice import Advice
from hybridid.advice.advise import advise

__all__ = ["Advice", "advise"]
