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
        return f"{self.port}.{self.effect.id}"
