"""Of each scenario: what is declared of its machine, and its records."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.league.machines import RUNS, Declared
from benchmarks.rebuilt import benches, dampers, rigs, tanks
from benchmarks.rebuilt.draw import Draw
from hybridid.plants.emps import EMPS
from hybridid.plants.servo import Servo
from hybridid.records.record import Record
from hybridid.rigs.servo import ServoTruth

RECORDERS = {
    "tanks": tanks.record,
    "friction_damper": dampers.record,
    "field_damper": dampers.record,
    "stiff_damper": dampers.record,
    "emps_rig": rigs.record,
    "servo_rig": rigs.record,
}
"""Of the machines that are not those of the drawn league."""


def declared(draw: Draw) -> Declared:
    """What a user declares of the machine of ``draw``: all of it but what is hidden."""
    p = draw.parameters
    if draw.machine == "tanks":
        # a pump is calibrated; with its flow free, the two tanks can exchange their time constants
        outlets = {name: p[name] for name in ("k_1", "k_2")}
        return Declared(tanks.Tanks(), (), 64, outlets, {"k_p": {"fixed": p["k_p"]}})
    if draw.machine.endswith("_damper"):
        plant = dampers.FieldDamper() if draw.machine == "field_damper" else dampers.FrictionDamper()
        own = {"viscous": "f_v", "coulomb": "f_c"}
        truth = {f"damper.{effect}.{name}": p[name] for effect, name in own.items() if name in p}
        effects = tuple(effect for effect, name in own.items() if name in p)
        return Declared(plant, effects, 200, {"k": p["k"], **truth})
    if draw.machine.endswith("_rig"):
        return _of_rig(draw)
    case = benches.case(draw)
    # 0.8 s, as a trace chooses for 8 s: over less, a start that is free hides a play
    horizon = 320 if draw.machine == "carriage" else case.horizon
    return replace(case, horizon=horizon)


def _of_rig(draw: Draw) -> Declared:
    """The virtual EMPS or the servo, with the friction that is declared of the measured one."""
    emps = draw.machine == "emps_rig"
    friction = {"viscous": "f_v", "coulomb": "f_c", "offset": "offset"}
    effects = {effect: name for effect, name in friction.items() if name in draw.parameters}
    port = "carriage" if emps else "joint"
    truth = {f"{port}.{effect}.{name}": draw.parameters[name] for effect, name in effects.items()}
    truth |= {name: value for name, value in draw.parameters.items() if name not in friction.values()}
    if emps:
        return Declared(EMPS(), tuple(effects), 1000, truth)
    return Declared(Servo(), tuple(effects), 120, {**truth, "q_0": ServoTruth().q_0})


def records_of(draw: Draw, quiet: bool = False, empty: bool = False) -> tuple[Record, Record]:
    """The records to fit on and to judge by. ``quiet``: without noise; ``empty``: with nothing hidden."""
    record = RECORDERS.get(draw.machine, benches.record)
    noise, amounts = 0.0 if quiet else draw.noise, {} if empty else draw.amounts
    first, second = (record(draw, run, noise, amounts) for run in RUNS)
    return first, second
