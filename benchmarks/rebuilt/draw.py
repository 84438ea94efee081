"""``Draw``: one scenario of the rebuilt rows, and all of them, from a fixed seed.

A row is a kind of physics that records of real machines, or simulated by others, were found to lack while a
trace said otherwise. Each is rebuilt on a rig of the same kind: 60 scenarios with the physics at work, spread
evenly over the rows, and 60 on the same rigs with nothing missing.

    parameters    nominal times 2^u, u uniform between -1/2 and 1/2
    amounts       of the hidden law, log-uniform between the bounds of ``Row.amounts``
    noise         log-uniform between the bounds of ``Row.noise``

All is drawn before anything is simulated.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

from benchmarks.drawn.draw import NOMINAL
from benchmarks.drawn.excitation import log_uniform

SEED, HALF = 20261123, 60
CATEGORIES = ("missing", "nothing")
Bounds = tuple[float, float]


@dataclass(frozen=True)
class Row:
    """``machine`` with its ``nominal`` parameters, the ``amounts`` of what it hides, and its sensor's
    ``noise`` (in the outputs' units). ``kinds`` are those of its excitation."""

    machine: str
    nominal: Mapping[str, float]
    amounts: Mapping[str, Bounds]
    noise: Bounds
    kinds: tuple[str, ...] = ("sines",)


TANKS = {"k_1": 0.05, "k_2": 0.055, "k_p": 0.04}  # sqrt(V)/s, sqrt(V)/s, 1/s
DAMPER = {"k": 3000.0, "f_v": 2000.0, "f_c": 60.0}  # N/m, N s/m, N
SPRUNG = {"k": 3000.0, "f_v": 2000.0}
# on ball guides: with the league's friction, the smoothed sign(v) leaves more error than this backlash
CARRIAGE = {**NOMINAL["carriage"], "f_v": 68.0, "f_c": 2.0, "offset": -0.3}
NOISE_OF_FORCE = (2.0, 10.0)
ROWS: Mapping[str, Row] = {
    # level: over the highest of the run without overflow; share: of what overflows that the lower tank gets
    "overflow": Row("tanks", TANKS, {"level": (0.6, 0.85), "share": (0.3, 1.0)}, (0.003, 0.03)),
    # share: of the drive's RMS effort; s: over the RMS displacement; stiffening: -delta / gamma
    "hysteresis": Row(
        "oscillator",
        NOMINAL["oscillator"],
        {"share": (0.03, 0.2), "s": (0.5, 1.5), "stiffening": (1.2, 1.6)},
        (2e-5, 3e-4),
        ("sines", "multisine"),
    ),
    # share: of the damper's own RMS force; gap (half of it) and s: over the stroke's standard deviation
    "friction_behind_gap": Row(
        "friction_damper",
        DAMPER,
        {"share": (0.15, 0.6), "gap": (0.1, 0.5), "s": (0.02, 0.1)},
        NOISE_OF_FORCE,
    ),
    "scaled_friction": Row("field_damper", DAMPER, {"share": (0.15, 1.0)}, NOISE_OF_FORCE),
    # stiffness: pre-sliding lengths travelled in a sample at top speed; form: below 1 Dahl, else Bouc-Wen
    "stiff": Row(
        "stiff_damper",
        SPRUNG,
        {"share": (0.15, 0.6), "stiffness": (100.0, 300.0), "form": (0.5, 2.0)},
        NOISE_OF_FORCE,
    ),
    # share: of the mass; place and width: over the stroke
    "varying_inertia": Row(
        "carriage",
        CARRIAGE,
        {"share": (0.05, 0.2), "place": (0.25, 0.75), "width": (0.15, 0.4)},
        (5e-6, 4e-5),
        ("moves", "sines"),
    ),
    # gap [m], whole; frequency [Hz] and damping of the closed contact; a third of the mass lies behind
    "backlash": Row(
        "carriage",
        CARRIAGE,
        {"gap": (30e-6, 150e-6), "frequency": (60.0, 150.0), "damping": (0.2, 0.5)},
        (1.5e-6, 4e-6),
        ("moves", "sines"),
    ),
    # how much stiffer in rebound than in compression
    "dampers": Row("half_car", NOMINAL["half_car"], {"front": (0.3, 0.7), "rear": (0.3, 0.7)}, (2e-4, 2e-3)),
}


@dataclass(frozen=True)
class Draw:
    """One scenario: ``amounts`` is empty where nothing is missing. ``seed`` is that of its signals."""

    number: int
    row: str
    parameters: Mapping[str, float]
    amounts: Mapping[str, float]
    noise: float
    kind: str

    @property
    def category(self) -> str:
        return "missing" if self.amounts else "nothing"

    @property
    def machine(self) -> str:
        return ROWS[self.row].machine

    @property
    def seed(self) -> int:
        return 7000 + self.number

    @property
    def key(self) -> str:
        """Readable and unique."""
        said = "-".join(f"{name}{value:.2g}" for name, value in self.amounts.items()) or "nothing"
        return f"{self.number:03}/{self.machine}/{self.row}/{said}/noise{self.noise:.2g}/{self.kind}"

    def described(self) -> dict[str, Any]:
        return {**asdict(self), "category": self.category, "machine": self.machine}

    def digest(self, version: str) -> str:
        """SHA-256 of the scenario and of ``version``, whatever decides its outcome besides."""
        said = json.dumps([self.described(), version], sort_keys=True)
        return hashlib.sha256(said.encode()).hexdigest()[:16]


@cache
def all_draws() -> tuple[Draw, ...]:
    """The 120 scenarios, always the same: 60 with something missing, then 60 without."""
    names = list(ROWS)
    return tuple(_draw(number, names[number % HALF % len(names)]) for number in range(2 * HALF))


def _draw(number: int, name: str) -> Draw:
    generator, row = np.random.default_rng([SEED, number]), ROWS[name]
    parameters = {k: float(value * 2 ** generator.uniform(-0.5, 0.5)) for k, value in row.nominal.items()}
    amounts = {k: log_uniform(generator, *bounds) for k, bounds in row.amounts.items()}
    noise = log_uniform(generator, *row.noise)
    kind = str(generator.choice(row.kinds))
    return Draw(number, name, parameters, amounts if number < HALF else {}, noise, kind)
