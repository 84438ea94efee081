"""``hybridid new``: a folder with a case and a plant, from recordings and a template."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from rich.console import RenderableType
from rich.text import Text

from hybridid.naming import unknown
from hybridid.records.channel import HOLDS, Hold, RecordError
from hybridid.records.mapping import SECONDS
from hybridid_cli.config_files import options
from hybridid_cli.tables import rendered, table
from pipelines.new.create import Request, new
from pipelines.new.machine import Machine
from pipelines.new.template import kinds, meanings
from pipelines.shared.errors import ConfigError


def command(name: str, words: Sequence[str]) -> int:
    """Write the folder and say what was found; without words, list the templates."""
    if not words:
        made = table("Templates", ("--template", "what it is"), words=(0, 1))
        for kind, meaning in meanings().items():
            made.add_row(kind, meaning)
        print(rendered([made]))
        return 0
    request = _request(words)
    if request.folder.name in options("case"):
        raise ConfigError(f"{request.folder.name} is already the name of a case: give another one")
    try:
        machine = new(request, _asked)
    except RecordError as error:
        raise ConfigError(str(error)) from error
    print(rendered(_told(machine)))
    return 0


class _Parser(argparse.ArgumentParser):
    """Raises a line instead of printing a page."""

    def error(self, message: str) -> NoReturn:
        raise ConfigError(f"{message}; see hybridid new --help")


def _request(words: Sequence[str]) -> Request:
    parser = _Parser(prog="hybridid new", add_help=False, allow_abbrev=False)
    parser.add_argument("name", type=Path)
    parser.add_argument("--from", dest="recordings", nargs="+", required=True, metavar="RECORDING")
    parser.add_argument("--template")
    parser.add_argument("--signal", action="append", default=[], metavar="SIGNAL=COLUMN")
    parser.add_argument("--scale", action="append", default=[], metavar="SIGNAL=NUMBER")
    parser.add_argument("--hold", action="append", default=[], metavar="SIGNAL=HOLD")
    parser.add_argument("--constant", action="append", default=[], metavar="PARAMETER=COLUMN")
    parser.add_argument("--simulated", action="store_true")
    axis = parser.add_mutually_exclusive_group()
    axis.add_argument("--time", metavar="COLUMN")
    axis.add_argument("--rate", type=float, metavar="HZ")
    parser.add_argument("--time-unit", metavar="UNIT")
    given = parser.parse_args(words)
    if given.template is None:
        raise ConfigError(f"--template is missing: {', '.join(kinds())}; hybridid new says what each is")
    if given.rate is not None and not 0 < given.rate < float("inf"):
        raise ConfigError(f"--rate is {given.rate:g}, it must be positive, in Hz")
    if given.time_unit is not None and given.time_unit not in SECONDS:
        raise ConfigError(f"--time-unit: {unknown('unit', given.time_unit, SECONDS)}")
    if given.time_unit is not None and given.rate is not None:
        raise ConfigError("--time-unit is that of time stamps, and --rate says that there are none: give one")
    return Request(
        folder=given.name,
        recordings=tuple(map(_files, given.recordings)),
        template=given.template,
        signals=_pairs("--signal", given.signal),
        scales={signal: _number(signal, text) for signal, text in _pairs("--scale", given.scale).items()},
        holds={signal: _hold(signal, text) for signal, text in _pairs("--hold", given.hold).items()},
        constants=_pairs("--constant", given.constant),
        time=given.time,
        time_unit=given.time_unit,
        rate=given.rate,
        simulated=given.simulated,
    )


def _files(word: str) -> tuple[Path, ...]:
    """The files of one recording, which + joins; a file may have a + in its name."""
    return (Path(word),) if Path(word).exists() else tuple(map(Path, word.split("+")))


_VALUES = {"--signal": "COLUMN", "--scale": "NUMBER", "--hold": "HOLD", "--constant": "COLUMN"}


def _pairs(flag: str, words: Sequence[str]) -> dict[str, str]:
    found = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not (name and equals and value):
            raise ConfigError(f"{flag} {word}: write {flag} SIGNAL={_VALUES[flag]}")
        found[name] = value
    return found


def _number(signal: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if value == 0 or value in (float("inf"), float("-inf")) or value != value:
        raise ConfigError(f"--scale {signal}={text}: it must be a number, finite and not 0")
    return value


def _hold(signal: str, text: str) -> Hold:
    if text not in HOLDS:
        raise ConfigError(f"--hold {signal}={text}: allowed: {', '.join(HOLDS)}")
    return text


def _asked(question: str, answers: Sequence[str]) -> str | None:
    """Put a question on the terminal; None where nobody is there, or the answer is none of them."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()) or not answers:
        return None
    listed = "\n".join(f"  {number}  {answer}" for number, answer in enumerate(answers, 1))
    print(f"{question}\n{listed}\nnumber: ", end="", file=sys.stderr, flush=True)
    said = sys.stdin.readline().strip()
    if said in answers:
        return said
    return answers[int(said) - 1] if said.isdecimal() and 0 < int(said) <= len(answers) else None


_BETWEEN = {
    "zoh": "held (zoh)",
    "foh": "linear (foh)",
    "bandlimited": "band-limited",
    None: "not given: assumed held",
}
_HOW = {
    "user": "--scale",
    "header": "the header",
    "bare": "the header; taken as recorded",
    "nothing": "assumed: the header names no unit",
}


def _told(machine: Machine) -> list[RenderableType]:
    signals = table(
        f"{machine.name}: {machine.template.about.meaning}",
        ("signal", "column", "unit", "scale", "unit known from", "between samples"),
        words=(0, 1, 2, 4, 5),
    )
    for one in machine.chosen:
        driven = one.signal in machine.template.inputs
        between = "–" if not driven else _BETWEEN[one.hold]
        signals.add_row(
            one.signal.name, one.column.name, one.signal.unit, f"{one.scale:.6g}", _HOW[one.told], between
        )
    for lacking in machine.template.absent:
        why = f"none: {machine.template.lack_of(lacking)}"
        signals.add_row(lacking.name, why, lacking.unit, "–", "–", "–")
    time = machine.time
    axis = f"column {time.column} in {time.unit}" if time.column else "no column"
    lines = [
        f"time: {axis}{' (assumed, else give --time-unit)' if time.assumed else ''}, "
        f"{machine.records[0].dt:.4g} s a sample"
        + ("" if machine.resample is None else f", uneven: resampled to {machine.resample:g} s")
    ]
    for recording, record in zip(machine.recordings, machine.records, strict=True):
        given = "".join(f", {name} {value:g}" for name, value in recording.constants.items())
        seconds = record.time[-1] - record.time[0]
        lines += [f"{record.name}: {record.n} samples, {seconds:.4g} s{given}"]
        lines += [line for line in record.warnings if ": resampled onto" not in line]
    lines += machine.template.about.remarks
    where = f"--config-dir {machine.folder} case={machine.name}"
    lines += [
        f"written: {machine.folder}",
        f"go on:  hybridid run {where}",
        f"        hybridid trace {where}",
    ]
    return [signals, *map(Text, lines)]
