"""Bad inputs: wrong values of every key of a config, damaged recordings, and tables made by hand."""

from __future__ import annotations

import typing
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.torture.bench import HALF, HANGS, TRACEBACK, UNCLEAR, WRONG, Fault, Found, Part
from benchmarks.torture.case import BORNE, REFUSED, Case, Said, faults
from benchmarks.torture.lab import csv, fit, lab, swing
from benchmarks.torture.play import load, play
from benchmarks.torture.tables import case_files, own_code, places, recordings, requests
from hybridid.settings import declared
from hybridid.settings.bounds import options
from pipelines.shared.sections.known import LONE, SECTIONS
from pipelines.shared.sections.residual import KINDS

RECORD = "lab/swing.csv"
RECORDS = 1800
"""Recordings that are damaged at random."""
VALUES: Mapping[str, tuple[str, ...]] = {
    "boolean": ("no", "maybe", "1", "[]", "null", "3.5", "''", "{a: 1}", "yes", "-0"),
    "number": ("abc", "[]", "{}", "true", "nan", "-1", "null", "1e400", "-1e400", "1e30", "'3'", "[[1]]"),
    "text": ("{a: 1}", "[a,b,{}]", "true", "3", "''", "null", "nan", "[]", "ü☃", "../../x", "a:b:c", "${x}"),
}
"""Wrong or odd values of a key, by what it takes."""
NEVER: Mapping[str, tuple[str, ...]] = {
    "boolean": ("no", "maybe", "1", "[]", "3.5", "{a: 1}", "yes"),
    "number": ("abc", "{}", "nan", "-1e400"),
    "text": ("{a: 1}", "${x}"),
}
"""Those that no key of the kind allows."""
TABLES = (own_code, case_files, requests, recordings, places)
_KINDS = {"a traceback": TRACEBACK, "no answer": HANGS, "left behind": HALF, "exit code": WRONG}
_MAPS = (
    "tune.space",
    "rig.truth",
    "rig.planted",
    "preprocess.steps",
    "trace.extra_effects",
    "residual.orders",
)

Damage = Callable[[np.random.Generator, list[list[str]]], str | bytes]


@dataclass(frozen=True)
class Input:
    """One bad input: ``category`` and ``key`` as ``Trial`` has them."""

    category: str
    key: str
    seed: int
    case: Case = field(compare=False)

    def carried_out(self, bench: Path) -> Found:
        """Give it to a command in a folder of its own."""
        load()
        said = play(self.case, lab)
        return Found(str(said), tuple(wrong_in(self.case, said)), {"bad inputs": 1})


def trials(seed: int) -> list[Input]:
    """All bad inputs: of configs, of recordings, and those of the tables."""
    return [*_configs(seed), *_records(seed), *_tables(seed)]


PART = Part(
    "inputs",
    "Recordings are damaged at random, and each key of a config is given wrong values. Plants and effects of "
    "the user's own, case files, command lines and recordings of every format are wrong in one place each. A "
    "command refuses the input in one clear line, or bears it where it may be right.",
    (WRONG, HALF, TRACEBACK, UNCLEAR, HANGS),
    trials,
    {"bad inputs": 3000},
)


def wrong_in(case: Case, said: Said) -> list[Fault]:
    """What is wrong with an answer, each with its kind."""
    return [Fault(_kind_of(what), f"{what}: {said.complaint[:200]}") for what in faults(case, said)]


def _kind_of(what: str) -> str:
    return next((kind for begin, kind in _KINDS.items() if what.startswith(begin)), UNCLEAR)


def _configs(seed: int) -> Iterator[Input]:
    every = [one for name, cls in SECTIONS.items() for one in declared(cls, f"{name}.")]
    every += [one for cls in LONE[:1] for one in declared(cls)]
    networks = [(kind, one) for kind, cls in KINDS.items() for one in declared(cls, "residual.")]
    for one in every:
        yield from _values(one.name, one.hint, (), seed)
    for kind, one in networks:
        yield from _values(one.name, one.hint, (f"residual={kind}",), seed)


def _values(name: str, hint: object, more: tuple[str, ...], seed: int) -> Iterator[Input]:
    kind = _taken(hint)
    for value in VALUES[kind]:
        must = value in NEVER[kind] and not name.startswith(_MAPS)
        words = fit(*more, f"{name}={value}", command="preprocess")
        key = f"inputs: {' '.join((*more, name))}={value}, seed {seed}"
        yield Input(kind, key, seed, Case(key, tuple(words), codes=REFUSED if must else BORNE))


def _taken(hint: object) -> str:
    """Whether a key takes booleans, numbers or text; lists count as what they hold."""
    found = set()
    for option in options(hint):
        found |= {option, *(x for x in typing.get_args(option) if not isinstance(x, str))}
    if bool in found:
        return "boolean"
    worded = str in found or typing.Literal in map(typing.get_origin, found)
    return "number" if {int, float} & found and not worded else "text"


def _records(seed: int) -> Iterator[Input]:
    names, sound = list(DAMAGES), [line.split(",") for line in csv(swing()).splitlines()]
    for number in range(RECORDS):
        name = names[number % len(names)]
        damage, must = DAMAGES[name]
        drawn = np.random.default_rng([seed, number])
        content = damage(drawn, [list(row) for row in sound])
        key = f"inputs: recording, {name}, seed {seed}.{number}"
        words = fit(command="fit" if number % 8 == 0 else "preprocess")
        case = Case(key, tuple(words), codes=REFUSED if must else BORNE, files={RECORD: content})
        yield Input(name, key, seed, case)


def _tables(seed: int) -> Iterator[Input]:
    for table in TABLES:
        for category, case in table.cases():
            yield Input(category, f"inputs: {case.name}, seed {seed}", seed, case)


def _joined(rows: list[list[str]], by: str = ",") -> str:
    return "\n".join(by.join(row) for row in rows) + "\n"


def _cell(values: tuple[str, ...]) -> Damage:
    """One of ``values`` in some cells."""

    def damage(drawn: np.random.Generator, rows: list[list[str]]) -> str:
        for _ in range(int(drawn.integers(1, 4))):
            rows[int(drawn.integers(1, len(rows)))][int(drawn.integers(0, 3))] = str(drawn.choice(values))
        return _joined(rows)

    return damage


def _bytes(drawn: np.random.Generator, rows: list[list[str]]) -> bytes:
    content = bytearray(_joined(rows).encode())
    for place in drawn.integers(0, len(content), int(drawn.integers(1, 30))):
        content[int(place)] = int(drawn.integers(0, 256))
    return bytes(content)


def _cut(drawn: np.random.Generator, rows: list[list[str]]) -> str:
    text = _joined(rows)
    return text[: int(drawn.integers(0, len(text)))]


def _moved(drawn: np.random.Generator, rows: list[list[str]]) -> str:
    place = int(drawn.integers(1, len(rows) - 20))
    moved = rows.pop(place)
    rows.insert(place + int(drawn.integers(2, 19)), moved)
    return _joined(rows)


def _ragged(drawn: np.random.Generator, rows: list[list[str]]) -> str:
    row = rows[int(drawn.integers(1, len(rows)))]
    row.extend(["1"] * int(drawn.integers(1, 5)))
    return _joined(rows)


def _header(drawn: np.random.Generator, rows: list[list[str]]) -> str:
    rows[0][int(drawn.integers(0, 3))] = str(drawn.choice(["", "x", "Angle ", "t t", "ü☃", "1", "a" * 5000]))
    return _joined(rows)


def _constant(drawn: np.random.Generator, rows: list[list[str]]) -> str:
    column, value = int(drawn.integers(0, 3)), str(drawn.choice(["0", "1e300", "-1e-300", "5"]))
    return _joined([rows[0], *([*row[:column], value, *row[column + 1 :]] for row in rows[1:])])


SEPARATORS = (";", "\t", " ", "|", ",,", "; ", "\0")
DAMAGES: Mapping[str, tuple[Damage, bool]] = {
    "text in cells": (_cell(("abc", "1.2.3", "0x1F", "#REF!", "1e", "--3", "true?")), True),
    "not finite": (_cell(("nan", "inf", "-inf", "NaN", "", "1e400")), True),
    "huge values": (_cell(("1e300", "-1e300", "1e-300", "1e18")), False),
    "bytes changed": (_bytes, False),
    "cut off": (_cut, False),
    "samples out of order": (_moved, True),
    "ragged": (_ragged, True),
    "wrong header": (_header, True),
    "few samples": (lambda drawn, rows: _joined(rows[: int(drawn.integers(1, 15))]), False),
    "constant column": (_constant, False),
    "other separators": (lambda drawn, rows: _joined(rows, str(drawn.choice(SEPARATORS))), False),
}
"""How a recording is damaged, and whether it must be refused."""
