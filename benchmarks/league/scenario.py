"""``Scenario``: one experiment of the league, as data."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from benchmarks.league.planting import Hidden

CATEGORIES = ("clean", "noisy", "partly_measured", "memory", "delay_or_lag", "outside", "nothing")


@dataclass(frozen=True)
class Scenario:
    """A machine with what it hides (nothing: a decoy) and the noise of its sensor.

    ``noise`` is a standard deviation in the output's unit; ``noise_memory`` its correlation from one sample
    to the next; ``noise_in_loop`` lets the controller read the recorded, noisy signal too.
    """

    machine: str
    category: str
    hidden: tuple[Hidden, ...]
    size: str
    noise: float
    seed: int = 0
    noise_memory: float = 0.0
    noise_in_loop: bool = False

    def __post_init__(self) -> None:
        if self.category not in CATEGORIES:
            raise ValueError(f"scenario: category {self.category!r}, allowed: {', '.join(CATEGORIES)}")

    @property
    def key(self) -> str:
        """Readable and unique."""
        what = "+".join(one.name for one in self.hidden) or "nothing"
        coloured = f"-memory{self.noise_memory:g}" if self.noise_memory else ""
        looped = "-in_loop" if self.noise_in_loop else ""
        return f"{self.machine}/{what}/{self.size}/noise{self.noise:g}{coloured}{looped}/seed{self.seed}"

    @property
    def truth(self) -> str | None:
        """What was planted, as ``port.effect``; None where nothing was."""
        return self.hidden[0].name if self.hidden else None

    def described(self) -> dict[str, Any]:
        plain = asdict(self)
        plain["hidden"] = [{"what": h.what, "port": h.port, "values": dict(h.values)} for h in self.hidden]
        return {**plain, "truth": self.truth}
