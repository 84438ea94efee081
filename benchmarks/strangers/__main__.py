"""``python -m benchmarks.strangers``: all that a stranger must be able to do, on one page. Each number says
whether it is simulated or measured."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from benchmarks.strangers import killed, report, servo
from benchmarks.strangers.asked import Answer, of_killed, of_rigs, of_servo, of_templates
from benchmarks.strangers.play import Machine, Outcome, machines, played
from benchmarks.studies import OUT, write
from hybridid.naming import unknown

TEMPLATES, SERVO, RIGS, KILLS = PARTS = ("templates", "servo", "rigs", "kills")


def main(arguments: Sequence[str] | None = None) -> int:
    """Play the parts that are asked for, and write their page to ``outputs/studies``."""
    asked = _parser().parse_args(arguments)
    found, sections = [], []
    for part in asked.parts if asked.only is None else _parts_of(asked.only):
        answer, section = _shown(part, asked)
        found.append(answer)
        sections.append(section)
        print(section, flush=True)
    print(report.answers(found))
    print(f"written: {write(OUT / 'strangers.md', report.page(found, sections))}")
    return 0


def _parts_of(names: Sequence[str]) -> list[str]:
    """The parts that hold these machines.

    Raises:
        SystemExit: if a name is none of a machine.
    """
    known = {one.name: RIGS if one.planted else TEMPLATES for one in machines()}
    for name in names:
        if name not in known:
            raise SystemExit(unknown("machine", name, known))
    return [part for part in (TEMPLATES, RIGS) if part in {known[name] for name in names}]


def _shown(part: str, asked: argparse.Namespace) -> tuple[Answer, str]:
    """What the page says of a part, once it was played: the answer, and the section."""
    if part == SERVO:
        measured, told = servo.records(), None
        if measured is not None:
            with _folder(asked.keep, SERVO) as folder:
                told = servo.played(measured, folder)
        return of_servo(told), report.servo(told)
    if part == KILLS:
        with _folder(asked.keep, KILLS) as folder:
            ended = killed.played(folder, asked.kills)
        return of_killed(ended), report.killed(ended)
    chosen = [one for one in machines() if asked.only is None or one.name in asked.only]
    planted = part == RIGS
    rows = list(_played(part, [one for one in chosen if one.planted == planted], asked))
    return (of_rigs(rows), report.rigs(rows)) if planted else (of_templates(rows), report.templates(rows))


def _played(part: str, chosen: Sequence[Machine], asked: argparse.Namespace) -> Iterator[Outcome]:
    """Each machine, played; its row is printed as it is done."""
    more = () if asked.processes is None else (f"trace.processes={asked.processes}",)
    for machine in chosen:
        with _folder(asked.keep, part, machine.name) as folder:
            found = played(machine, folder, more)
        print(*report.row(found), sep=" | ", flush=True)
        yield found


@contextmanager
def _folder(keep: Path | None, *names: str) -> Iterator[Path]:
    """A new folder of these names, below ``keep``, or one that is removed afterwards."""
    with tempfile.TemporaryDirectory(prefix="strangers-") as scratch:
        folder = (keep or Path(scratch)).resolve().joinpath(*names)
        folder.mkdir(parents=True)
        yield folder


def _parser() -> argparse.ArgumentParser:
    words = argparse.ArgumentParser(prog="python -m benchmarks.strangers", description=__doc__)
    words.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="parts (default: all)")
    words.add_argument("--only", nargs="+", metavar="MACHINE", help="machines, and nothing else")
    words.add_argument("--kills", type=int, default=killed.KILLS, help="how often a trace is killed")
    words.add_argument("--processes", type=int, help="of each machine's trace (default: all cores)")
    words.add_argument("--keep", type=Path, help="folder that keeps recordings and reports")
    return words


if __name__ == "__main__":
    raise SystemExit(main())
