"""What a player of the league says of a scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True)
class Answer:
    """``named``: what it adds to the declared model, ``port.effect``, in its own order; empty: it abstains.

    ``alike`` is the class of the first, itself included, that the player cannot tell apart. ``before`` and
    ``after`` are held-out errors in the player's own measure, over the spread of what it predicts;
    ``values`` the first effect's parameters. ``remains`` says that something is left that it cannot name.
    """

    player: str
    named: tuple[str, ...] = ()
    alike: tuple[str, ...] = ()
    values: Mapping[str, float] = field(default_factory=dict)
    before: float = float("nan")
    after: float = float("nan")
    remains: bool = False
    seconds: float = 0.0
    notes: Mapping[str, Any] = field(default_factory=dict)

    def described(self) -> dict[str, Any]:
        return asdict(self)
