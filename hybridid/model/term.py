"""``Term``: an effect at a port of a plant, or at several ports alike."""

from __future__ import annotations

from dataclasses import dataclass

from hybridid.effects.effect import Effect
from hybridid.plants.plant import TOGETHER


@dataclass(frozen=True)
class Term:
    """An effect at a port, or at several with one set of parameters: ``front_damper+rear_damper``. A flow
    that leads into another level acts at two: out of the first, into the second.

    Raises:
        ValueError: if an effect with states of its own acts at several ports, or one that leads into another
            level not at two.
    """

    effect: Effect
    port: str

    def __post_init__(self) -> None:
        if len(self.ports) > 1 and self.effect.states:
            raise ValueError(
                f"effect {self.effect.id} has states of its own: it acts at one port, not {self.port}"
            )
        if self.effect.into and len(self.ports) != 2:
            raise ValueError(
                f"effect {self.effect.id} leads from one level into another: name both, as "
                f"{self.effect.id}@FIRST{TOGETHER}SECOND, not {self.port}"
            )

    @property
    def name(self) -> str:
        """``port.effect``, the prefix of the qualified names of its parameters and states."""
        return f"{self.port}.{self.effect.id}"

    @property
    def ports(self) -> tuple[str, ...]:
        """The names of the ports where it acts."""
        return tuple(self.port.split(TOGETHER))
