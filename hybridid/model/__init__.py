"""Models: a plant plus effects at its ports."""

from hybridid.model.compose import compose
from hybridid.model.model import Model, Term, first_port

__all__ = ["Model", "Term", "compose", "first_port"]
