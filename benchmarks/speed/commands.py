"""What the commands themselves take: help, a config, a warm fit, a run with its figures."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import yaml

from benchmarks.speed.row import OURS, Row
from benchmarks.studies import cpu_seconds
from hybridid_cli.config_files import conf_folder

COMMANDS = "commands"
SHORT = ("case=emps", "data=simulated", "rig.duration=8.0")
MANY = 16


def commands(repeats: int, say: Callable[[str], None], quick: bool) -> Iterator[Row]:
    """Wall time of whole processes, one after another. The records of a warm fit are there already."""
    yield _timed("hybridid --help", ["--help"], repeats, say)
    yield _timed("hybridid fit --cfg job", ["fit", "case=emps", "--cfg", "job"], repeats, say)
    with TemporaryDirectory() as folder:
        for logged in (False, True):
            words = ["fit", *SHORT, f"paths.outputs={folder}", f"out={folder}/tree"]
            words += [f"mlflow.enabled={str(logged).lower()}"]
            what = f"hybridid fit, 8 s of record, warm, {'with' if logged else 'without'} MLflow"
            _seconds(words)  # what is compiled is kept, and so are the records
            row = _timed(what, words, repeats, say, lambda k: [f"parameters.M.lower={30 + 0.01 * (k + 1)}"])
            row.details["in the solver"] = _kept(Path(folder) / "tree/fit/estimate.json", "seconds")
            yield row
    if not quick:
        yield _figures("2 records", SHORT, repeats, say)
        with TemporaryDirectory() as lab:
            _write_case(Path(lab))
            many = ("--config-dir", lab, "case=many", *SHORT[1:])
            yield _figures(f"{MANY} records", many, repeats, say)


def _figures(what: str, words: Sequence[str], repeats: int, say: Callable[[str], None]) -> Row:
    """The figures of a run, whose other stages are fresh; and what the whole run takes."""
    with TemporaryDirectory() as folder:
        rest = [*words, f"out={folder}/tree", "mlflow.enabled=false"]
        whole = _seconds(["run", *rest])
        formats = (["plot.formats=[svg,png]"], ["plot.formats=[svg]"])
        what = f"hybridid run, figures of {what}"
        row = _timed(what, ["run", *rest], repeats, say, lambda k: formats[k % 2])
        row.details["the whole run"] = whole
        row.details["in the stage of the figures"] = _kept(Path(folder) / "tree/plot/stage.json", "seconds")
        row.details["in the stage of the fit"] = _kept(Path(folder) / "tree/fit/stage.json", "seconds")
        return row


def _write_case(lab: Path) -> None:
    """A case with ``MANY`` records of the rig, but else the EMPS."""
    text = (conf_folder() / "case" / "emps.yaml").read_text(encoding="utf-8")
    config = yaml.safe_load(text)
    held_out = config["records"]["validation"]
    more = {f"validation_{k}": {**held_out, "run": "validation"} for k in range(2, MANY)}
    config["records"] |= more
    (lab / "case").mkdir()
    head = "# @package _global_\n"
    (lab / "case" / "many.yaml").write_text(head + yaml.safe_dump(config, allow_unicode=True), "utf-8")


def _timed(
    what: str,
    words: Sequence[str],
    repeats: int,
    say: Callable[[str], None],
    more: Callable[[int], Sequence[str]] = lambda k: (),
) -> Row:
    """``more`` are the words of each repeat that differ from those of the last one: without, all is fresh."""
    before = cpu_seconds()
    seconds = tuple(_seconds([*words, *more(k)]) for k in range(repeats))
    busy = (cpu_seconds() - before) / repeats
    row = Row(
        COMMANDS, what, OURS, seconds, "exit code 0", "simulated" if "data=simulated" in words else "none"
    )
    row.details["of the processor"] = busy
    say(f"{what}: {row.median:.2f} s, {busy:.2f} s of the processor")
    return row


def _seconds(words: Sequence[str]) -> float:
    """Wall seconds of ``hybridid WORDS``.

    Raises:
        RuntimeError: if the command fails.
    """
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "hybridid_cli", *words],
        capture_output=True, text=True, check=False, env={**os.environ, "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"hybridid {' '.join(words)}: {done.stderr.strip()[-500:]}")
    return time.perf_counter() - began


def _kept(file: Path, key: str) -> float:
    """Seconds that a stage noted, in the last repeat; of parts their sum."""
    seconds = json.loads(file.read_text())[key]
    return float(sum(seconds.values()) if isinstance(seconds, dict) else seconds)
