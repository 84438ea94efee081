"""The drawn machines: benches and cars with the parameters of a ``Draw``, and what is declared of each.

The machines, their declared models and horizons are those of the league; masses, frictions, springs, gains,
excitations and noise are drawn. What the league declares as known (the eSEA's inertias and spring, the car's
mass) is declared with its drawn value.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from benchmarks.drawn.draw import Draw
from benchmarks.drawn.excitation import moves, sines
from benchmarks.league.bench import Bench, Loop
from benchmarks.league.machines import CASES, CLOSED, LINK, OSCILLATOR, PUSHED, RUNS, VOLTS_TO_TORQUE, Case
from hybridid.records.record import Channel
from hybridid.rigs.law_library import COULOMB, OFFSET, STIFFNESS, VISCOUS
from hybridid.rigs.loop import CascadedPD

BACK_EMF = VOLTS_TO_TORQUE * 70.0 * 7.68e-3
BANDS = {
    "carriage": (0.2, 0.8), "carriage_open": (0.3, 4.0), "oscillator": (5.0, 120.0),
    "flexible_link": (0.3, 5.0), "esea": (0.2, 4.0),
}  # fmt: skip
RMS = {"carriage": 0.04, "carriage_open": 55.0, "oscillator": 0.015, "flexible_link": 1.6, "esea": 0.25}
"""Of the input or, in a loop, of the reference: m, N, V, V, rad."""
COUNTS = {"sines": 3, "multisine": 16, "switching": 4}


def bench_of(draw: Draw) -> Bench:
    """The machine of ``draw`` with its excitation, nothing hidden; every machine but the half-car."""
    made = {"carriage": _carriage, "carriage_open": _carriage, "oscillator": _oscillator,
            "flexible_link": _link, "esea": _esea}[draw.machine](draw.parameters)  # fmt: skip
    return replace(made, runs={run: _excitation(draw, k) for k, run in enumerate(RUNS)})


def _excitation(draw: Draw, run: int):
    generator = np.random.default_rng([draw.seed, 10 + run])
    if draw.kind == "moves":
        return moves(generator).position
    how = {"rests": draw.machine in ("carriage", "esea"), "switches": draw.kind == "switching"}
    level = RMS[draw.machine] * 2 ** generator.uniform(-0.5, 0.5)
    return sines(generator, COUNTS[draw.kind], BANDS[draw.machine], level, **how)


def _carriage(p: Mapping[str, float]) -> Bench:
    own = VISCOUS(f_v=p["f_v"]), COULOMB(f_c=p["f_c"]), OFFSET(offset=p["offset"])
    loop = replace(CLOSED, controller=CascadedPD(kp=p["kp"], kv=p["kv"])) if "kp" in p else None
    return replace(PUSHED, mass=((p["M"],),), own={"carriage": own}, loop=loop)


def _oscillator(p: Mapping[str, float]) -> Bench:
    own = STIFFNESS(k=p["k"], q_0=0.0), VISCOUS(f_v=p["d"])
    return replace(OSCILLATOR, mass=((p["m"],),), own={"oscillator": own})


def _link(p: Mapping[str, float]) -> Bench:
    own = {
        "servo": (VISCOUS(f_v=BACK_EMF + p["f_v_servo"]),),
        "link": (STIFFNESS(k=p["K_s"], q_0=0.0), VISCOUS(f_v=p["f_v_link"])),
    }
    return replace(LINK, mass=((p["J_eq"], 0.0), (0.0, p["J_l"])), own=own, back_emf=BACK_EMF)


def _esea(p: Mapping[str, float]) -> Bench:
    """Motor and link in a loop on the motor's angle; the link's velocity is measured as such."""
    return Bench(
        name="esea",
        mass=((p["J"], 0.0), (0.0, p["I"])),
        input_matrix=((1.0,), (0.0,)),
        contacts={"motor": (1.0, 0.0), "elastomer": (1.0, -1.0), "link": (0.0, 1.0)},
        own={"motor": (VISCOUS(f_v=p["f_v"]),), "elastomer": (STIFFNESS(k=p["K_e"], q_0=0.0),)},
        input=Channel("torque", "N·m", "zoh"),
        outputs={"link_velocity": ((0.0, 1.0), True, "rad/s")},
        runs={},
        dt=2e-3,
        duration=6.0,
        loop=Loop(CascadedPD(kp=p["stiffness"] / p["damping"], kv=p["damping"]), gain=1.0, limit=1.99),
    )


def viscous_at(draw: Draw, port: str) -> float:
    """The machine's own viscous friction at ``port``; at the servo what the motor's back-EMF brakes too."""
    p = draw.parameters
    return {
        "carriage": p.get("f_v"),
        "oscillator": p.get("d"),
        "servo": BACK_EMF + p.get("f_v_servo", 0.0),
        "link": p.get("f_v_link", 0.0),
        "motor": p.get("f_v"),
        "elastomer": 0.0,
        "front_suspension": p.get("c_f"),
        "rear_suspension": p.get("c_r"),
    }[port] or 0.0  # fmt: skip


def case_of(draw: Draw) -> Case:
    """The league's case with what is drawn: the true values of what is fitted, and what is known."""
    case, p = CASES[draw.machine], draw.parameters
    known = {
        "esea": {"I": p.get("I"), "J": p.get("J"), "K_e": p.get("K_e")},
        "half_car": {"m_c": p.get("m_c")},
    }.get(draw.machine, {})
    declared = {name: {"fixed": value} for name, value in known.items() if value is not None}
    return replace(case, truth=_truth(draw), adjustments={**case.adjustments, **declared})


def _truth(draw: Draw) -> dict[str, float]:
    p = draw.parameters
    if draw.machine in ("carriage", "carriage_open"):
        named = {
            f"carriage.{e}.{n}": p[n]
            for e, n in (("viscous", "f_v"), ("coulomb", "f_c"), ("offset", "offset"))
        }
        return {"M": p["M"], **named}
    if draw.machine == "oscillator":
        return {"m": p["m"], "d": p["d"], "k": p["k"], "V2_0": 0.0}
    if draw.machine == "flexible_link":
        own = {name: p[name] for name in ("J_eq", "J_l", "K_s")}
        return {**own, "servo.viscous.f_v": p["f_v_servo"], "link.viscous.f_v": p["f_v_link"]}
    if draw.machine == "esea":
        return {"motor.viscous.f_v": p["f_v"]}
    return {name: p[name] for name in ("I_yy", "k_f", "k_r", "c_f", "c_r", "k_t")}
