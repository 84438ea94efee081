"""``Draw``: one scenario of the rebuilt rows, and all of them, from a fixed seed.

A row is a kind of physics that records of real machines, or simulated by others, were found to lack while a
trace said otherwise. Each is rebuilt on a rig of the same kind: 60 scenarios with the physics at work, spread
evenly over the rows, and 60 on the same rigs with nothing missing.

    parameters    nominal times 2^u, u uniform between -1/2 and 1/2
    amounts       of the hidden law, log-uniform between the bounds of ``Row.amounts``
    noise         log-uniform between the bounds of ``Row.noise``

Beside them: friction in proportion to the load, and a drive that saturates, planted on four machines. Either
takes 3-20 % of the drive's RMS effort, at four levels of noise.

All is drawn before anything is simulated. A series of draws is known once somebody looked at its answers; the
next one is as new as the first was.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

from benchmarks.drawn.draw import NOMINAL
from benchmarks.drawn.excitation import between, log_uniform

SEED, HALF = 20261123, 60
A_SERIES = 1000
"""Numbers from one series of draws to the next: a further one judges after somebody looked at the first."""
CATEGORIES = ("missing", "nothing", "load_friction", "saturation")
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
        ("multisine",),
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
EMPS = {"M": 95.0, "f_v": 203.0, "f_c": 20.4, "offset": -3.2}
SERVO = {"J": 1.8e-3, "k_t": 0.3, "R_s": 1.0, "f_v": 3e-3, "f_c": 0.01}
SHARE = {"share": (0.03, 0.2)}
LEVELS, EACH = 4, 2
"""Levels of noise of a planted row, evenly spread (log) from its least to its most, and scenarios at each."""
PLANTED: Mapping[str, Row] = {
    "load_friction@carriage": Row("carriage", CARRIAGE, SHARE, (2e-6, 5e-5), ("moves", "sines")),
    "load_friction@emps_rig": Row("emps_rig", EMPS, SHARE, (1e-6, 5e-5)),
    "load_friction@servo_rig": Row("servo_rig", SERVO, SHARE, (3e-4, 3e-3)),
    "load_friction@esea": Row("esea", NOMINAL["esea"], SHARE, (2e-3, 5e-2), ("sines", "multisine")),
    # the EMPS rig records the force behind its own limit, the servo's plant has no path for its torque
    "saturation@carriage": Row("carriage", CARRIAGE, SHARE, (2e-6, 5e-5), ("moves", "sines")),
    "saturation@esea": Row("esea", NOMINAL["esea"], SHARE, (2e-3, 5e-2), ("sines", "multisine")),
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
        what, _, planted = self.row.partition("@")
        return what if planted else "missing" if self.amounts else "nothing"

    @property
    def machine(self) -> str:
        return {**ROWS, **PLANTED}[self.row].machine

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


@cache
def all_draws(series: int = 0) -> tuple[Draw, ...]:
    """Always the same in a ``series``: 60 with something missing, 60 without, then the planted ones."""
    names, first = list(ROWS), A_SERIES * series
    rows = [_draw(first + k, names[k % HALF % len(names)], k < HALF) for k in range(2 * HALF)]
    places = [(name, level, half) for name in PLANTED for level in range(LEVELS) for half in range(EACH)]
    return (*rows, *(_planted(first + 2 * HALF + k, *place) for k, place in enumerate(places)))


def _draw(number: int, name: str, hides: bool) -> Draw:
    generator, row = np.random.default_rng([SEED, number]), ROWS[name]
    parameters = _parameters(generator, row)
    amounts = {k: log_uniform(generator, *bounds) for k, bounds in row.amounts.items()}
    noise = log_uniform(generator, *row.noise)
    kind = str(generator.choice(row.kinds))
    return Draw(number, name, parameters, amounts if hides else {}, noise, kind)


def _planted(number: int, name: str, level: int, half: int) -> Draw:
    """Of the ``level`` of noise; the share is in that ``half`` of its bounds (log)."""
    generator, row = np.random.default_rng([SEED, number]), PLANTED[name]
    parameters = _parameters(generator, row)
    share = between((half + generator.uniform()) / EACH, *row.amounts["share"])
    noise = between(level / (LEVELS - 1), *row.noise)
    return Draw(number, name, parameters, {"share": share}, noise, str(generator.choice(row.kinds)))


def _parameters(generator: np.random.Generator, row: Row) -> dict[str, float]:
    return {k: float(value * 2 ** generator.uniform(-0.5, 0.5)) for k, value in row.nominal.items()}
