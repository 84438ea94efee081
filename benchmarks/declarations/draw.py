"""``Draw``: one scenario of the study, and all 40 of them, from a fixed seed.

    friction         viscous friction is declared at the port, and there is none: Coulomb friction and
                     quadratic drag are there in its place (10 draws)
    spring           a linear spring is declared at the port, and there is none (10 draws)
    sound_friction   the declared friction is the true one (10 draws)
    sound_spring     a linear spring is declared, and there is one (10 draws)

The machines are those of the drawn league. As there, all else is drawn from a generator of the draw's own:

    parameters       nominal times 2^u, u uniform between -1/2 and 1/2; the gains of a loop alike
    noise            log-uniform between the bounds of ``benchmarks.drawn.draw.NOISE``
    excitation       one of ``benchmarks.drawn.draw.KINDS``
    shares           what each law takes of the drive's RMS effort in the run that is fitted, log-uniform
                     between the bounds of ``SHARES``

All is drawn before anything is simulated. ``machines`` finds the amounts that give the shares.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

from benchmarks.drawn import draw as league
from benchmarks.drawn.excitation import log_uniform

SEED, FIRST = 20261125, 600_000
"""``FIRST``: added to a draw's number, the seed of its signals is none of the drawn league's."""
FRICTION, SPRING, SOUND_FRICTION, SOUND_SPRING = CATEGORIES = (
    "friction", "spring", "sound_friction", "sound_spring",
)  # fmt: skip
WRONG = (FRICTION, SPRING)
SLIDING = (
    "carriage", "oscillator", "flexible_link", "carriage_open", "carriage",
    "oscillator", "flexible_link", "carriage_open", "carriage", "carriage_open",
)  # fmt: skip
SPRUNG = (
    "carriage", "carriage_open", "flexible_link", "carriage", "carriage_open",
    "flexible_link", "carriage", "carriage_open", "flexible_link", "carriage",
)  # fmt: skip
"""The oscillator's own spring could not be told from a declared one."""
MACHINES: Mapping[str, tuple[str, ...]] = {
    FRICTION: SLIDING, SPRING: SPRUNG, SOUND_FRICTION: SLIDING, SOUND_SPRING: SPRUNG,
}  # fmt: skip
COULOMB, DRAG, STIFFNESS = "coulomb", "quadratic_drag", "linear_stiffness"
SHARES: Mapping[str, Mapping[str, tuple[float, float]]] = {
    FRICTION: {COULOMB: (0.08, 0.4), DRAG: (0.08, 0.4)},
    SPRING: {},
    SOUND_FRICTION: {},
    SOUND_SPRING: {STIFFNESS: (0.08, 0.4)},
}


@dataclass(frozen=True)
class Draw:
    """One scenario. ``shares`` are those of the laws at the port that the drawn league's machine has not, by
    the effect's id."""

    number: int
    category: str
    machine: str
    parameters: Mapping[str, float]
    noise: float
    kind: str
    shares: Mapping[str, float]

    @property
    def bare(self) -> league.Draw:
        """The machine in the drawn league's terms, with its excitation and nothing hidden."""
        return league.Draw(
            FIRST + self.number, self.machine, "nothing", self.parameters, self.kind, self.noise, None
        )

    @property
    def port(self) -> str:
        """Where the declaration may be wrong."""
        return {"oscillator": "oscillator", "flexible_link": "servo"}.get(self.machine, "carriage")

    @property
    def key(self) -> str:
        """Readable and unique."""
        said = "+".join(f"{name}{100 * share:.0f}%" for name, share in self.shares.items()) or "nothing"
        return f"{self.number:02}/{self.machine}/{self.category}/{said}/noise{self.noise:.2g}/{self.kind}"

    def described(self) -> dict[str, Any]:
        return {**asdict(self), "port": self.port}


@cache
def all_draws() -> tuple[Draw, ...]:
    """The 40 scenarios, always the same: one of each category in turn."""
    places = [(category, MACHINES[category][k]) for k in range(len(SLIDING)) for category in CATEGORIES]
    return tuple(drawn(number, *place) for number, place in enumerate(places))


def drawn(number: int, category: str, machine: str) -> Draw:
    """The scenario of a number; from 40 on, one that the study does not play."""
    generator = np.random.default_rng([SEED, number])
    nominal = league.NOMINAL[machine]
    return Draw(
        number=number,
        category=category,
        machine=machine,
        parameters={k: float(value * 2 ** generator.uniform(-0.5, 0.5)) for k, value in nominal.items()},
        noise=log_uniform(generator, *league.NOISE[machine]),
        kind=str(generator.choice(league.KINDS[machine])),
        shares={name: log_uniform(generator, *bounds) for name, bounds in SHARES[category].items()},
    )
