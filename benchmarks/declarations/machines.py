"""The machines of the study: what each truly is, what is declared of it, and its records. All simulated.

The drawn league's bench integrates the truth, and shares no code with the trace. A few simulations find the
amounts of the laws at the port, which take the drawn shares:

    share = RMS(effort of the law) / RMS(effort of the drive),    in the run to fit

Each multiplies an amount by wanted over found. Where the machine all but stands still, all are halved.

The oscillator's damper is declared as an effect, and the one of its plant is fixed at zero: a trace leaves
out effects, not parameters of a plant.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache

from benchmarks.declarations.draw import (
    COULOMB,
    DRAG,
    FRICTION,
    SOUND_SPRING,
    SPRING,
    STIFFNESS,
    Draw,
    drawn,
)
from benchmarks.drawn import machines as league
from benchmarks.drawn.machines import BACK_EMF
from benchmarks.drawn.recipes import rms
from benchmarks.drawn.told import Seen, perform
from benchmarks.league.bench import Bench, Sensor
from benchmarks.league.machines import RUNS, Case
from hybridid.records.record import Record
from hybridid.rigs import law_library as laws
from hybridid.rigs.laws import Planted, RigError

ROUNDS, NEAR, HELD = 12, 0.03, 0.2
"""``HELD``: a port stands still that moves less than this share of its motion in the league's machine."""
OWN_LAWS = ("viscous", "coulomb")
Amounts = Mapping[str, float]


def records_of(draw: Draw, quiet: bool = False) -> tuple[Record, Record]:
    """The records to fit on and to judge by; ``quiet``: without noise."""
    found, noise = amounts(draw), 0.0 if quiet else draw.noise
    first, second = (_simulated(draw, found, run, noise).record for run in RUNS)
    return _named(first), _named(second)


def _named(record: Record) -> Record:
    return replace(record, source=record.source.replace("drawn league", "study of declarations"))


def amounts(draw: Draw) -> Amounts:
    """The amounts that take the shares of ``draw``, by the effect's id; the nearest that were found.

    Raises:
        RigError: if no amount can be simulated.
    """
    return _amounts(draw.number, draw.category, draw.machine)


@cache
def _amounts(number: int, category: str, machine: str) -> Amounts:
    draw = drawn(number, category, machine)
    if not draw.shares:
        return {}
    port = draw.port
    plain = [perform(league.bench_of(draw.bare), run, _sensors(draw, 0.0), draw.bare.seed) for run in RUNS]
    spreads = [seen.motion[port][0].std() for seen in plain]
    found = _first_guess(draw, plain[0])
    best: tuple[float, Amounts] = math.inf, {}
    for _ in range(ROUNDS):
        shares = _shares(draw, found, spreads)
        if shares is None:
            found = {name: 0.5 * amount for name, amount in found.items()}
            continue
        off = max(abs(math.log(max(shares[name], 1e-9) / wanted)) for name, wanted in draw.shares.items())
        best = min(best, (off, found), key=lambda one: one[0])
        if off < NEAR:
            break
        ratios = {name: wanted / max(shares[name], 1e-9) for name, wanted in draw.shares.items()}
        found = {name: amount * min(max(ratios[name], 0.3), 3.0) for name, amount in found.items()}
    if not best[1]:
        raise RigError(f"study of declarations {draw.key}: no amounts can be simulated")
    return best[1]


def _first_guess(draw: Draw, plain: Seen) -> Amounts:
    """Amounts that take the shares along the motion of the drawn league's machine."""
    position, velocity = plain.motion[draw.port]
    of_one = {COULOMB: 1.0, DRAG: rms(velocity**2), STIFFNESS: rms(position)}
    return {name: share * rms(plain.drive) / of_one[name] for name, share in draw.shares.items()}


def _shares(draw: Draw, found: Amounts, spreads: list[float]) -> dict[str, float] | None:
    """What each law takes in the run to fit; None where the port all but stands still in a run, or the truth
    cannot be integrated."""
    try:
        seen = [_simulated(draw, found, run, 0.0) for run in RUNS]
    except RigError:
        return None
    moved = [one.motion[draw.port][0].std() for one in seen]
    if any(each < HELD * before for each, before in zip(moved, spreads, strict=True)):
        return None
    efforts = zip(found, seen[0].efforts, strict=True)
    return {name: rms(effort) / rms(seen[0].drive) for name, effort in efforts}


def _simulated(draw: Draw, found: Amounts, run: str, noise: float) -> Seen:
    planted = [_law(name, amount) for name, amount in found.items()]
    bench = replace(_rest(draw), planted={draw.port: tuple(planted)})
    return perform(bench, run, _sensors(draw, noise), draw.bare.seed, planted)


def _law(name: str, amount: float) -> Planted:
    if name == COULOMB:
        return laws.COULOMB(f_c=amount)
    return laws.QUADRATIC_DRAG(c=amount) if name == DRAG else laws.STIFFNESS(k=amount, q_0=0.0)


def _rest(draw: Draw) -> Bench:
    """The machine without the laws of the draw: the drawn league's. Where the declared friction is wrong, its
    own at the port is left out, but for the motor's back-EMF, which the plant knows."""
    bench, port = league.bench_of(draw.bare), draw.port
    if draw.category != FRICTION:
        return bench
    own = tuple(one for one in bench.own[port] if one.law.name not in OWN_LAWS)
    if port == "servo":
        own = (laws.VISCOUS(f_v=BACK_EMF), *own)
    return replace(bench, own={**bench.own, port: own})


def _sensors(draw: Draw, noise: float) -> dict[str, Sensor]:
    return dict.fromkeys(league.bench_of(draw.bare).outputs, Sensor(noise))


def declared(draw: Draw) -> Case:
    """What is declared, with the values from which the oracle starts: the true ones, a machine's own viscous
    friction where that is wrong."""
    case, port = _own_case(draw), draw.port
    terms = case.declared
    if draw.category == FRICTION:
        terms = tuple(one for one in terms if one.partition("@")[0] != COULOMB)
    if draw.category not in (SPRING, SOUND_SPRING):
        return _of_terms(case, terms, {})
    stiffness = {f"{port}.{STIFFNESS}.k": 0.0}
    if draw.category == SOUND_SPRING:
        stiffness = {f"{port}.{STIFFNESS}.k": amounts(draw)[STIFFNESS]}
    return _of_terms(case, (*terms, f"{STIFFNESS}@{port}"), stiffness)


def true_case(draw: Draw) -> Case:
    """The model that is the truth, at its true values: what should have been declared."""
    if draw.category == SPRING:
        return _own_case(draw)
    if draw.category != FRICTION:
        return declared(draw)
    case, port, found = declared(draw), draw.port, amounts(draw)
    kept = tuple(one for one in case.declared if one not in ("viscous", f"viscous@{port}"))
    named = {f"{port}.{COULOMB}.f_c": found[COULOMB], f"{port}.{DRAG}.c_d": found[DRAG]}
    return _of_terms(case, (*kept, f"{COULOMB}@{port}", f"{DRAG}@{port}"), named)


def _own_case(draw: Draw) -> Case:
    """The drawn league's declaration, the truth of its machine; the oscillator's damper as an effect."""
    case = league.case_of(draw.bare)
    if draw.machine != "oscillator":
        return case
    truth = {name: value for name, value in case.truth.items() if name != "d"}
    truth["oscillator.viscous.f_v"] = case.truth["d"]
    return replace(case, declared=("viscous",), truth=truth, adjustments={"d": {"fixed": 0.0}})


def _of_terms(case: Case, terms: tuple[str, ...], values: Mapping[str, float]) -> Case:
    """``case`` with the effects ``terms`` declared; true values of parameters that the model then has."""
    made = replace(case, declared=terms)
    names = {p.name for p in made.model().free}
    return replace(made, truth={k: v for k, v in {**case.truth, **values}.items() if k in names})
