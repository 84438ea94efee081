"""The machines of the league: what each truly is, what is declared of it, and how it is excited.

The carriage is the virtual EMPS under a softer loop, the oscillator the Silverbox, the flexible link
Quanser's; they run on ``Bench``. The eSEA and the half-car are the rigs of ``hybridid.rigs``. Records are
short and sampled as a field engineer would keep them, so that a trace takes a minute or two: carriage 8 s
at 400 Hz, oscillator 5 s at 610 Hz, flexible link 8 s at 250 Hz, eSEA 6 s at 500 Hz, half-car 10 s at
100 Hz over a track of bumps.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.league.bench import Bench, Drive, Loop, Sensor
from benchmarks.league.planting import Hidden
from benchmarks.league.scenario import Scenario
from hybridid.effects.effect import Effect
from hybridid.model import Model
from hybridid.model.compose import compose
from hybridid.plants.duffing import Duffing
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.plants.flexible_link import FlexibleLink
from hybridid.plants.half_car import HalfCar
from hybridid.plants.plant import Plant
from hybridid.records.record import Channel, Record
from hybridid.rigs.esea import FRICTIONS, ESEAConfig, ESEARig, ESEATruth
from hybridid.rigs.half_car import HalfCarConfig, HalfCarRig
from hybridid.rigs.half_car_truth import HalfCarTruth
from hybridid.rigs.law_library import COULOMB, OFFSET, STIFFNESS, VISCOUS
from hybridid.rigs.loop import CascadedPD, Encoder
from hybridid.rigs.rig import Experiment
from hybridid.rigs.road import Bump
from hybridid.rigs.sweep import LinearSweep
from hybridid.rigs.trajectory import BangBang, Move

Array = NDArray[np.float64]
RUNS = ("identification", "validation")


@dataclass(frozen=True)
class Declared:
    """A plant and the effects that are ``declared`` of it; horizons of ``horizon`` samples.

    ``truth`` holds the true values of the declared model's parameters, for the oracle.
    """

    plant: Plant
    declared: tuple[str, ...]
    horizon: int
    truth: Mapping[str, float]
    adjustments: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def model(self, declared: tuple[str | Effect, ...] | None = None) -> Model:
        return compose(self.plant, self.declared if declared is None else declared, self.adjustments)


@dataclass(frozen=True)
class Case(Declared):
    """The same with its records, by scenario and run."""

    record: Callable[[Scenario, str], Record] = field(kw_only=True)


def records_of(scenario: Scenario) -> tuple[Record, Record]:
    """The records that every player gets: to fit on, and to judge by."""
    case = CASES[scenario.machine]
    first, second = (case.record(scenario, run) for run in RUNS)
    return first, second


# --- on the bench ------------------------------------------------------------------------------------------


def _on_bench(bench: Bench, others: Mapping[str, float] | None = None) -> Callable[[Scenario, str], Record]:
    """``others``: noise of the further outputs over the first's."""

    def record(scenario: Scenario, run: str) -> Record:
        made, lag = bench, 0.0
        for one in scenario.hidden:
            made, lag = _hiding(made, one, lag)
        if made.loop is not None:
            made = replace(made, loop=replace(made.loop, recorded=scenario.noise_in_loop))
        scale = {next(iter(bench.outputs)): 1.0, **(others or {})}
        sensors = {
            name: Sensor(factor * scenario.noise, scenario.noise_memory, lag=lag)
            for name, factor in scale.items()
        }
        return made.record(run, sensors, scenario.seed)

    return record


def _hiding(bench: Bench, one: Hidden, lag: float) -> tuple[Bench, float]:
    if one.what == "sensor_lag":
        return bench, one.values["lag"]
    if one.on_path:
        return replace(bench, drive=Drive(**{**vars(bench.drive), **one.values})), lag
    planted = {**bench.planted, one.port: (*bench.planted.get(one.port, ()), one.planted.what)}
    return replace(bench, planted=planted), lag


CARRIAGE = {"M": 95.0, "f_v": 203.0, "f_c": 20.4, "offset": -3.2}
FIRST_WAY = BangBang(
    0.02,
    (
        Move(0.03, 0.06, 0.84), Move(0.0, 0.042, 0.6), Move(0.12, 0.2, 1.2), Move(0.2, 0.04, 0.5),
        Move(0.06, 0.25, 1.4), Move(0.1, 0.08, 0.84), Move(0.0, 0.12, 0.84),
    ),
)  # fmt: skip
SECOND_WAY = BangBang(
    0.02,
    (
        Move(0.08, 0.15, 1.0), Move(0.05, 0.03, 0.5), Move(0.21, 0.22, 1.3), Move(0.14, 0.07, 0.7),
        Move(0.17, 0.05, 0.6), Move(0.02, 0.24, 1.1), Move(0.0, 0.05, 0.84),
    ),
)  # fmt: skip


def _force(time: Array, lines: tuple[tuple[float, float, float], ...]) -> Array:
    """A sum of sines: (amplitude, frequency [Hz], phase)."""
    return np.sum([a * np.sin(2 * np.pi * f * time + phase) for a, f, phase in lines], axis=0)


def _carriage(loop: Loop | None, offset: float = CARRIAGE["offset"]) -> Bench:
    own = (VISCOUS(f_v=CARRIAGE["f_v"]), COULOMB(f_c=CARRIAGE["f_c"]))
    pushed = ((55.0, 0.4, 0.3), (35.0, 1.1, 1.0), (25.0, 2.7, 2.0))
    otherwise = ((50.0, 0.55, 1.3), (40.0, 0.9, 0.0), (28.0, 3.3, 0.7))
    runs = (
        {"identification": FIRST_WAY.position, "validation": SECOND_WAY.position}
        if loop
        else {
            "identification": lambda t: _force(t, pushed),
            "validation": lambda t: _force(t, otherwise),
        }
    )
    return Bench(
        name="carriage",
        mass=((CARRIAGE["M"],),),
        input_matrix=((1.0,),),
        contacts={"carriage": (1.0,)},
        own={"carriage": (*own, OFFSET(offset=offset))},
        input=Channel("force", "N", "zoh"),
        outputs={"position": ((1.0,), False, "m")},
        runs=runs,
        dt=2.5e-3,
        duration=8.0,
        loop=loop,
    )


CLOSED = Loop(CascadedPD(kp=40.0, kv=120.0), gain=35.15, limit=351.5)
PUSHED = _carriage(None)

K_V, D_V = 0.96, 2.4e-4  # 1, s
M_V = K_V / (2 * math.pi * 68.0) ** 2  # s², resonance at 68 Hz
RATE = 610.35


def _multisine(time: Array, seed: int) -> Array:
    """24 sines of random phase between 5 and 120 Hz, 10 mV RMS, and 20 mV towards the end."""
    generator = np.random.default_rng(seed)
    lines = generator.uniform(5, 120, 24)
    sum_ = np.sum([np.sin(2 * np.pi * f * time + generator.uniform(0, 2 * np.pi)) for f in lines], axis=0)
    return 0.01 * (1 + time / time[-1]) * sum_ / sum_.std()


OSCILLATOR = Bench(
    name="oscillator",
    mass=((M_V,),),
    input_matrix=((1.0,),),
    contacts={"oscillator": (1.0,)},
    own={"oscillator": (STIFFNESS(k=K_V, q_0=0.0), VISCOUS(f_v=D_V))},
    input=Channel("V1", "V", "zoh"),
    outputs={"V2": ((1.0,), False, "V")},
    runs={"identification": lambda t: _multisine(t, 1), "validation": lambda t: _multisine(t, 2)},
    dt=1 / RATE,
    duration=5.0,
)

J_EQ, J_L, K_S, SERVO_F_V, LINK_F_V = 0.0021, 0.0038, 1.3, 0.004, 0.002
VOLTS_TO_TORQUE = 0.9 * 0.69 * 70.0 * 7.68e-3 / 2.6
LINK = Bench(
    name="flexible_link",
    mass=((J_EQ, 0.0), (0.0, J_L)),
    input_matrix=((VOLTS_TO_TORQUE,), (0.0,)),
    contacts={"servo": (1.0, 0.0), "link": (-1.0, 1.0)},
    own={
        "servo": (VISCOUS(f_v=VOLTS_TO_TORQUE * 70.0 * 7.68e-3 + SERVO_F_V),),
        "link": (STIFFNESS(k=K_S, q_0=0.0), VISCOUS(f_v=LINK_F_V)),
    },
    input=Channel("voltage", "V", "zoh"),
    outputs={"servo_angle": ((1.0, 0.0), False, "rad"), "tip_angle": ((-1.0, 1.0), False, "rad")},
    runs={
        "identification": lambda t: _force(t, ((1.5, 0.5, 0.0), (1.2, 1.7, 1.0), (0.8, 3.6, 2.0))),
        "validation": lambda t: _force(t, ((1.3, 0.7, 1.0), (1.3, 1.4, 0.0), (0.9, 4.3, 0.5))),
    },
    dt=4e-3,
    duration=8.0,
)

# --- the rigs of the package -------------------------------------------------------------------------------


def _esea(scenario: Scenario, run: str) -> Record:
    """Encoders with ``noise`` [rad]; the link's velocity is what its filter makes of the counts."""
    gain = math.prod(one.values["gain"] for one in scenario.hidden if one.what == "input_gain")
    laws = tuple(one.planted for one in scenario.hidden if not one.on_path)
    config = ESEAConfig(
        truth=ESEATruth(torque_gain=gain, planted=(*FRICTIONS["linear"], *laws)),
        encoder=Encoder(resolution=2 * math.pi / 2**16, noise_std=scenario.noise),
        identification=LinearSweep(0.323, 0.1, 5.0, 6.0),
        validation=LinearSweep(0.401, 0.1, 3.5, 6.0, math.pi),
    )
    return ESEARig(config).record(run, scenario.seed, 6.0)


@dataclass(frozen=True)
class Track:
    """Bumps (foot [m], height [m], length [m]) one after another, on a level road."""

    bumps: tuple[tuple[float, float, float], ...]

    def __call__(self, x: Array) -> Array:
        return np.sum([Bump(height, length)(x - foot) for foot, height, length in self.bumps], axis=0)


TRACK = Track(
    ((0, 0.12, 1.8), (7, 0.05, 0.9), (13, 0.06, 2.5), (19, 0.09, 1.2), (26, 0.04, 4.0), (34, 0.1, 2.2))
)


def _half_car(scenario: Scenario, run: str) -> Record:
    """Vertical velocity, ideally integrated, and pitch rate with white ``noise`` [m/s, rad/s]."""
    laws = tuple(one.planted for one in scenario.hidden)
    rig = HalfCarRig(HalfCarConfig(truth=HalfCarTruth(planted=laws), bump=TRACK))  # type: ignore[arg-type]
    made = rig.experiment(run, scenario.seed, 10.0)
    source = f"virtual rig half_car over a track of bumps, {run} run, seed {scenario.seed} (simulated)"
    return driven(rig, made, run, scenario.noise, scenario.seed, source)


def driven(rig: HalfCarRig, made: Experiment, run: str, noise: float, seed: int, source: str) -> Record:
    """A drive of the half-car as its sensors recorded it, with white ``noise`` [m/s, rad/s]."""
    generator = np.random.default_rng([seed, RUNS.index(run)])
    true = np.column_stack([made.truth["vertical_velocity"], made.truth["pitch_rate"]])
    return Record(
        name=run,
        time=made.time,
        inputs=np.column_stack([made.inputs["u_f"], made.inputs["u_r"]]),
        outputs=true + noise * generator.standard_normal(true.shape),
        input_channels=rig.input_channels,
        output_channels=(Channel("vertical_velocity", "m/s"), Channel("pitch_rate", "rad/s")),
        simulated=True,
        source=source,
    )


SYMMETRIC = ("viscous", "coulomb", "offset")
MOVING = {
    "M": CARRIAGE["M"],
    "carriage.viscous.f_v": CARRIAGE["f_v"],
    "carriage.coulomb.f_c": CARRIAGE["f_c"],
    "carriage.offset.offset": CARRIAGE["offset"],
}
LEVEL = {name: value for name, value in MOVING.items() if not name.startswith("carriage.offset")}
SPRUNG = {"m": M_V, "d": D_V, "k": K_V, "V2_0": 0.0}
FLEXING = {
    "J_eq": J_EQ,
    "J_l": J_L,
    "K_s": K_S,
    "servo.viscous.f_v": SERVO_F_V,
    "link.viscous.f_v": LINK_F_V,
}
ROLLING = {name: getattr(HalfCarTruth(), name) for name in ("I_yy", "k_f", "k_r", "c_f", "c_r", "k_t")}
CASES: Mapping[str, Case] = {
    "carriage": Case(EMPS(), SYMMETRIC, 160, MOVING, record=_on_bench(_carriage(CLOSED))),
    "carriage_open": Case(EMPS(), SYMMETRIC, 160, MOVING, record=_on_bench(PUSHED)),
    # nobody declared an offset, and there is none
    "carriage_level": Case(
        EMPS(), SYMMETRIC[:2], 160, LEVEL, record=_on_bench(_carriage(CLOSED, offset=0.0))
    ),
    "oscillator": Case(Duffing(), (), 150, SPRUNG, record=_on_bench(OSCILLATOR)),
    "flexible_link": Case(
        FlexibleLink(),
        ("viscous@servo", "viscous@link"),
        100,
        FLEXING,
        record=_on_bench(LINK, {"tip_angle": 1.0}),
    ),
    "esea": Case(
        ESEA(),
        ("viscous@motor",),
        150,
        {"motor.viscous.f_v": 0.01},
        {"motor.epsilon": {"fixed": 0.1}, "motor.viscous.f_v": {"guess": 0.01, "lower": 0.0, "upper": 0.1}},
        record=_esea,
    ),
    "half_car": Case(
        HalfCar(),
        (),
        50,
        ROLLING,
        {
            "I_yy": {"guess": 2000.0, "lower": 500.0, "upper": 1e4},
            **{name: {"guess": 3e4, "lower": 5e3, "upper": 2e5} for name in ("k_f", "k_r")},
            **{name: {"guess": 2e3, "lower": 200.0, "upper": 1e4} for name in ("c_f", "c_r")},
            "k_t": {"guess": 5e5, "lower": 2e5, "upper": 1e7},
        },
        record=_half_car,
    ),
}
