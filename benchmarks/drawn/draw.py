"""``Draw``: one scenario as it was drawn, and the 120 of each series of the league, from a fixed seed.

    hidden             an effect of the library 45 %, a law that the library has not 35 %, nothing 20 %
    machine            by ``WEIGHTS``
    its parameters     nominal times 2^u, u uniform between -1/2 and 1/2; the gains of its loop alike
    noise              log-uniform between the bounds of ``NOISE``
    share              what the hidden effect takes of the drive's RMS effort, log-uniform from 3 % to 60 %
    chances            uniform between 0 and 1: they set the hidden law's shape (see ``recipes``)

All is drawn before anything is simulated; the amplitude that gives the share is found by ``amount``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

from benchmarks.drawn.excitation import log_uniform
from benchmarks.drawn.offers import COMPOSED, EITHER_WAY, LATE, LIBRARY, OUTSIDE, composed_factors

SEED, COUNT = 20261122, 120
A_SERIES = 10_000
"""Numbers from one series of draws to the next: a further one judges after somebody looked at the first."""
CATEGORIES = ("library", "outside", "nothing")
SHARES = {"library": 54, "outside": 42, "nothing": 24}
WEIGHTS = {
    "carriage": 0.30, "carriage_open": 0.19, "oscillator": 0.19, "flexible_link": 0.12, "esea": 0.08,
    "half_car": 0.12,
}  # fmt: skip
NOMINAL: Mapping[str, Mapping[str, float]] = {
    "carriage": {"M": 95.0, "f_v": 203.0, "f_c": 20.4, "offset": -3.2, "kp": 30.0, "kv": 120.0},
    "carriage_open": {"M": 95.0, "f_v": 203.0, "f_c": 20.4, "offset": -1.5},
    "oscillator": {"m": 5.3e-6, "d": 2.4e-4, "k": 0.96},
    "flexible_link": {"J_eq": 0.0021, "J_l": 0.0038, "K_s": 1.3, "f_v_servo": 0.004, "f_v_link": 0.002},
    "esea": {"I": 0.0014, "J": 0.0001, "K_e": 8.459, "f_v": 0.01, "stiffness": 3.0, "damping": 0.02},
    "half_car": {
        "m_c": 1250.0, "I_yy": 2441.0, "k_f": 22223.0, "k_r": 52916.0, "c_f": 2273.6, "c_r": 1938.6,
        "k_t": 5.2e5, "speed": 5.2,
    },
}  # fmt: skip
NOISE = {
    "carriage": (5e-6, 1e-4), "carriage_open": (5e-6, 1e-4), "oscillator": (2e-5, 1e-3),
    "flexible_link": (2e-5, 2e-3), "esea": (2e-3, 5e-2), "half_car": (2e-4, 5e-3),
}  # fmt: skip
"""Standard deviation of the sensor: m, m, V, rad, rad/s, and m/s and rad/s of the half-car. The least is at
or above the error of the declared model's own numerics (some 5 µm of the carriage)."""
KINDS = {
    "carriage": ("moves", "sines"),
    "half_car": ("long", "short"),
    **dict.fromkeys(("carriage_open", "oscillator", "flexible_link"), ("sines", "multisine", "switching")),
    "esea": ("sines", "multisine"),
}
LEAST, MOST = 0.03, 0.60


@dataclass(frozen=True)
class Wanted:
    """A law to hide: ``what`` at each of ``ports`` alike, with the ``share`` of the drive's RMS effort.

    ``factors`` are those of a composed law. ``sign`` is that of a law that may push as well as resist.
    """

    what: str
    ports: tuple[str, ...]
    share: float
    chances: tuple[float, ...]
    sign: int = 1
    factors: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """``port.effect`` at each port."""
        return tuple(f"{port}.{self.what}" for port in self.ports)


@dataclass(frozen=True)
class Draw:
    """One scenario of the drawn league; ``kind`` is that of its excitation, ``seed`` that of its signals."""

    number: int
    machine: str
    category: str
    parameters: Mapping[str, float]
    kind: str
    noise: float
    wanted: Wanted | None

    @property
    def seed(self) -> int:
        return 1000 + self.number

    @property
    def key(self) -> str:
        """Readable and unique."""
        hidden = "nothing"
        if self.wanted:
            amount = "late" if self.wanted.what in LATE else f"{100 * self.wanted.share:.0f}%"
            hidden = f"{'+'.join(self.wanted.names)}/{amount}"
        return f"{self.number:03}/{self.machine}/{hidden}/noise{self.noise:.2g}/{self.kind}"

    def described(self) -> dict[str, Any]:
        return asdict(self)


@cache
def all_draws(series: int = 0) -> tuple[Draw, ...]:
    """The 120 scenarios of a ``series``, always the same."""
    deck = [category for category in CATEGORIES for _ in range(SHARES[category])]
    np.random.default_rng(SEED + series).shuffle(deck)
    return tuple(_draw(number, category) for number, category in enumerate(deck, A_SERIES * series))


def draw_of(number: int) -> Draw:
    """The scenario of a number: one of the league, or beyond a series one that the league does not play.

    Beyond, even numbers hide an effect of the library, odd ones nothing.
    """
    series, place = divmod(number, A_SERIES)
    if place < COUNT:
        return all_draws(series)[place]
    return _draw(number, "nothing" if number % 2 else "library")


def _draw(number: int, category: str) -> Draw:
    generator = np.random.default_rng([SEED, number])
    machine = str(generator.choice(list(WEIGHTS), p=list(WEIGHTS.values())))
    parameters = {
        name: float(value * 2 ** generator.uniform(-0.5, 0.5)) for name, value in NOMINAL[machine].items()
    }
    return Draw(
        number=number,
        machine=machine,
        category=category,
        parameters=parameters,
        kind=str(generator.choice(KINDS[machine])),
        noise=log_uniform(generator, *NOISE[machine]),
        wanted=None if category == "nothing" else _wanted(generator, machine, category),
    )


def _wanted(generator: np.random.Generator, machine: str, category: str) -> Wanted:
    offers = (LIBRARY if category == "library" else OUTSIDE)[machine]
    what, ports = offers[generator.integers(len(offers))]
    factors = composed_factors(generator, machine) if what == COMPOSED else ()
    return Wanted(
        what="*".join(factors) or what,
        ports=ports,
        share=log_uniform(generator, LEAST, MOST),
        chances=tuple(float(x) for x in generator.uniform(size=4)),
        sign=int(generator.choice((-1, 1))) if factors and factors[0] in EITHER_WAY else 1,
        factors=factors,
    )
