"""Of each scenario: what is declared of its machine, and its records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from benchmarks.league.machines import RUNS, Case
from benchmarks.rebuilt import benches, dampers, tanks
from benchmarks.rebuilt.draw import Draw
from hybridid.model import Model
from hybridid.model.compose import compose
from hybridid.plants.plant import Plant
from hybridid.records.record import Record

RECORDERS = {
    "tanks": tanks.record,
    "friction_damper": dampers.record,
    "field_damper": dampers.record,
    "stiff_damper": dampers.record,
}
"""Of the machines that were made for this bench; the others are those of the drawn league."""


@dataclass(frozen=True)
class Declared:
    """``plant`` with the effects that are declared, horizons of ``horizon`` samples, and the true values."""

    plant: Plant
    effects: tuple[str, ...]
    horizon: int
    truth: Mapping[str, float]
    adjustments: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def model(self) -> Model:
        return compose(self.plant, self.effects, self.adjustments)


def declared(draw: Draw) -> Declared:
    """What a user declares of the machine of ``draw``: all of it but what is hidden."""
    p = draw.parameters
    if draw.machine == "tanks":
        return Declared(tanks.Tanks(), (), 64, dict(p))
    if draw.machine.endswith("_damper"):
        plant = dampers.FieldDamper() if draw.machine == "field_damper" else dampers.FrictionDamper()
        own = {"viscous": "f_v", "coulomb": "f_c"}
        truth = {f"damper.{effect}.{name}": p[name] for effect, name in own.items() if name in p}
        effects = tuple(effect for effect, name in own.items() if name in p)
        return Declared(plant, effects, 200, {"k": p["k"], **truth})
    case: Case = benches.case(draw)
    # 0.8 s, as a trace chooses for 8 s: over less, a start that is free hides a play
    horizon = 320 if draw.machine == "carriage" else case.horizon
    return Declared(case.plant, case.declared, horizon, case.truth, case.adjustments)


def records_of(draw: Draw, quiet: bool = False, empty: bool = False) -> tuple[Record, Record]:
    """The records to fit on and to judge by. ``quiet``: without noise; ``empty``: with nothing hidden."""
    record = RECORDERS.get(draw.machine, benches.record)
    noise, amounts = 0.0 if quiet else draw.noise, {} if empty else draw.amounts
    first, second = (record(draw, run, noise, amounts) for run in RUNS)
    return first, second
