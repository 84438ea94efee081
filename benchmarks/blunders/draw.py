"""``Draw``: one simulated experiment of the study, with a planted blunder or without, from its number alone.

    sign       of one channel, or of all inputs of one unit
    unit       a length in mm as m, an angle in degrees as rad, a force or torque in thousandths
    swapped    two columns of the file
    missing    a law that the model lacks and that matters
    plant      the record of one machine fitted with the model of another

A missing law matters if the model leaves at least ``MATTERS`` times what it leaves of the same experiment
without the law. Draws in which it does not are drawn again: nobody could tell them from sound ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.blunders.laws import lacking
from benchmarks.blunders.machines import MACHINES, Bench, Generator
from hybridid.estimators import FitSettings, fit
from hybridid.model import Model, compose
from hybridid.plants.duffing import Duffing
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.records.record import Record
from hybridid.rigs.laws import RigError

KINDS = ("sign", "unit", "swapped", "missing", "plant")
SOUND = "sound"
JUDGED, DEVELOPED = 20261124, 7
"""Seeds of the draws that judge, and of those that the rules were developed on."""
MATTERS = 5.0
ATTEMPTS = 30
DEGREES = 180.0 / np.pi
SIGNS = {
    "emps": (("force",), ("position",)),
    "esea": (("torque",), ("link_velocity",)),
    "vehicle": (("u_f", "u_r"), ("u_f",), ("u_r",), ("pitch_rate",), ("vertical_acceleration",)),
    "servo": (("goal",), ("position",)),
}
"""Channels whose sign is reversed together."""
UNITS = {
    "emps": ((("position",), 1e3), (("force",), 1e3)),
    "esea": ((("link_velocity",), DEGREES), (("torque",), 1e3)),
    "vehicle": ((("u_f", "u_r"), 1e3), (("pitch_rate",), DEGREES), (("vertical_acceleration",), 1e3)),
    "servo": (
        (("position",), DEGREES),
        (("goal",), DEGREES),
        (("goal", "position"), DEGREES),
        (("supply",), 1e3),
    ),
}
"""Channels that are recorded in another unit than declared, and how many of those make one of the
declared."""
SWAPS = {
    "emps": (("force", "position"),),
    "esea": (("torque", "link_velocity"),),
    "vehicle": (("u_f", "u_r"), ("vertical_acceleration", "pitch_rate")),
    "servo": (("goal", "position"), ("kp", "supply")),
}
LACKS_AT = {"vehicle": ("front_suspension", "rear_suspension")}
"""Where a law is planted, if not at every port: a tyre's is hidden by what the filter takes."""
OTHERS = ("emps", "esea", "duffing")
"""Plants of one input and one output."""


@dataclass(frozen=True)
class Case:
    """What is fitted: records, model and settings, with what is ``planted`` in words (empty: nothing)."""

    kind: str
    machine: str
    planted: str
    records: tuple[Record, ...]
    model: Model
    settings: FitSettings


def drawn(kind: str, number: int, seed: int) -> Case:
    """The draw ``number`` of a kind; ``seed`` is ``JUDGED`` or ``DEVELOPED``."""
    generator = np.random.default_rng([seed, (SOUND, *KINDS).index(kind), number])
    machine = str(generator.choice(tuple(MACHINES)))
    if kind == "missing":
        return _missing(machine, generator)
    bench = MACHINES[machine](generator)
    raw = bench.recorded()
    if kind == "plant":
        return _other_plant(bench, raw, generator)
    said, changed = "", raw
    if kind == "sign":
        names = SIGNS[machine][generator.integers(len(SIGNS[machine]))]
        said, changed = (
            f"sign of {' and '.join(names)}",
            [_scaled(r, dict.fromkeys(names, -1.0)) for r in raw],
        )
    elif kind == "unit":
        names, factor = UNITS[machine][generator.integers(len(UNITS[machine]))]
        said = f"{' and '.join(names)} times {factor:.4g}"
        changed = [_scaled(r, dict.fromkeys(names, factor)) for r in raw]
    elif kind == "swapped":
        pair = SWAPS[machine][generator.integers(len(SWAPS[machine]))]
        said, changed = f"{pair[0]} and {pair[1]}", [_swapped(r, pair) for r in raw]
    return _case(kind, bench, said, changed)


def _case(kind: str, bench: Bench, said: str, raw: Sequence[Record]) -> Case:
    return Case(kind, bench.name, said, tuple(bench.prepared(list(raw))), bench.model, bench.settings)


def _missing(machine: str, generator: Generator) -> Case:
    for _ in range(ATTEMPTS):
        bench = MACHINES[machine](generator)
        twin = _case("missing", bench, "", bench.recorded())
        law = lacking(twin.model, LACKS_AT.get(machine, bench.rig.ports), generator)
        try:
            other = bench.planted(law)
            found = _case("missing", other, law.said(), other.recorded())
            leaves, left = (fit(c.model, c.records, c.settings).cost for c in (found, twin))
        except (RigError, ValueError):  # a truth that diverges, or a model that does: drawn again
            continue
        if leaves >= MATTERS**2 * left:
            return found
    raise RuntimeError(f"{machine}: no law mattered in {ATTEMPTS} attempts")


def _other_plant(bench: Bench, raw: Sequence[Record], generator: Generator) -> Case:
    """One input and one output of a machine, as if they were those of another."""
    other = str(generator.choice([name for name in OTHERS if name != bench.name]))
    model = {
        "emps": lambda: compose(EMPS(), ["viscous", "coulomb", "offset"]),
        "esea": lambda: compose(ESEA(), ["viscous@motor"]),
        "duffing": lambda: compose(Duffing(), []),
    }[other]()
    records = []
    for record in bench.prepared(list(raw)):
        one_in = replace(record.input_channels[0], name=model.inputs[0].name, unit=model.inputs[0].unit)
        k = int(len(record.output_channels) > 1)
        one_out = replace(record.output_channels[k], name=model.outputs[0].name, unit=model.outputs[0].unit)
        records.append(
            replace(
                record,
                inputs=record.inputs[:, :1],
                outputs=record.outputs[:, k : k + 1],
                input_channels=(one_in,),
                output_channels=(one_out,),
                auxiliary=None,
                auxiliary_channels=(),
                warnings=(),
            )
        )
    return Case("plant", bench.name, f"the model of {other}", tuple(records), model, FitSettings())


def _scaled(record: Record, factors: dict[str, float]) -> Record:
    by_input = [factors.get(c.name, 1.0) for c in record.input_channels]
    by_output = [factors.get(c.name, 1.0) for c in record.output_channels]
    return replace(record, inputs=record.inputs * by_input, outputs=record.outputs * by_output, warnings=())


def _swapped(record: Record, pair: tuple[str, str]) -> Record:
    names = [c.name for c in (*record.input_channels, *record.output_channels)]
    a, b = (names.index(name) for name in pair)
    both = np.column_stack([record.inputs, record.outputs])
    both[:, [a, b]] = both[:, [b, a]]
    n_u = record.inputs.shape[1]
    return replace(record, inputs=both[:, :n_u], outputs=both[:, n_u:], warnings=())
