"""``Term``: an effect at a port of a plant."""

from __future__ import annotations

from dataclasses import dataclass

from hybridid.effects.effect import Effect


@dataclass(frozen=True)
class Term:
    """An effect at a port."""

    effect: Effect
    port: str

    @property
    def name(self) -> str:
        """``port.effect``, the prefix of the qualified names of its parameters and states."""
        return f"{self.port}.{self.effect.id}"
