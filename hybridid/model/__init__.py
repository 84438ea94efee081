"""Models: a plant plus effects at its ports."""

from hybridid.model.compose import compose
from hybridid.model.model import Model, first_port
from hybridid.model.term import Term

__all__ = ["Model", "Term", "compose", "first_port"]
