"""What a colleague mailed: model files, run folders, recordings. None of the code in them may run."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from benchmarks.torture import archives, poisoned
from benchmarks.torture import bench as kinds
from benchmarks.torture.bench import ROOT, Fault, Found, Part, Trial
from benchmarks.torture.case import BORNE, Case
from benchmarks.torture.commands import NETWORK, SVG, TWO, Words
from benchmarks.torture.inputs import wrong_in
from benchmarks.torture.lab import CASE, OWN, lab
from benchmarks.torture.play import answer, load, new_folder, write
from benchmarks.torture.tables.decoys import CANARY, Trap
from benchmarks.torture.tables.folders import DATA, HERE, JOB, RUN_FOLDER
from benchmarks.torture.tables.received import MODEL, QUICK, TAKE, TRAPS

SECONDS = 120.0
SCRIPT = f"""import sys
sys.path.append({str(ROOT)!r})
from hybridid_cli.main import main
if __name__ == "__main__":
    main()
"""
"""``hybridid`` as it is installed: Python looks for modules beside this file, not where the user stands."""
HONEST = (*QUICK, *NETWORK)
GO_ON: Mapping[str, Words] = {"validate": HONEST, "plot": (*HONEST, *SVG), "run": (*HONEST, *SVG)}
"""Commands that go on in a run folder."""
RUN = tuple(command for command in TAKE if command != "preprocess")
"""Commands that make the model, and so run its code."""
OPEN, PORT = "is open on this machine", 5987
"""What ``ui`` says, and where it opens its page."""
ANYWHERE: tuple[Words, ...] = (
    *((command, *QUICK, *more) for command, more in TAKE.items()),
    ("sweep", *QUICK, "launcher=joblib", "estimator.horizon=250,500"),
    ("trace", *QUICK, "trace.effects=[stribeck]", "trace.processes=2"),
    ("reproduce", "data=simulated", "rig.duration=1.2", "mlflow.enabled=false", *TWO),
    ("fetch", "case=emps", "archive.url=http://127.0.0.1:9/x"),
    ("log",),
    ("cases",),
    ("effects",),
    ("completion", "bash"),
    ("trust", "."),
    ("trust",),
    ("fit", *QUICK, "--experimental-rerun=.hydra/config.pickle"),
    ("fit", "mlflow.enabled=true", *QUICK[:-2], "out=tree"),
    ("--help",),
    ("ui", f"port={PORT}"),
)  # fmt: skip


@dataclass(frozen=True)
class Opened:
    """A command where ``trap`` lies; ``anew``: Python starts anew. ``honest``: in a run folder."""

    category: str
    trap: Trap
    words: Words
    seed: int
    anew: bool = False
    honest: bool = False

    @property
    def key(self) -> str:
        own = [word for word in self.words if word not in (*HONEST, *SVG, *OWN, MODEL)]
        return f"received: {self.category}, {self.trap.name}: {' '.join(own)}, seed {self.seed}"

    def carried_out(self, bench: Path) -> Found:
        """Give the commands, and look whether any code ran."""
        load()
        canary, script = bench / "canary", bench / "hybridid"
        canary.unlink(missing_ok=True)
        script.write_text(SCRIPT, encoding="utf-8")
        with new_folder(bench) as folder:
            own = environment(bench, folder)
            lab(folder)
            if self.honest:
                shutil.copytree(honest(bench), folder / "tree")
            for name, content in self.trap.files.items():
                write(folder / name, content)
            for line in self.trap.before:
                answer(line, folder, SECONDS, own)
            for name, content in self.trap.changed.items():
                write(folder / name, content)
            opens = OPEN if self.words[0] == "ui" else ""
            said = answer(self.words, folder, SECONDS, own, script if self.anew else None, opens)
        case = Case(self.key, self.words, self.trap.says, self.trap.codes, seconds=SECONDS)
        wrong = wrong_in(case, said)
        if self.trap.runs and not canary.exists():
            wrong.append(Fault(kinds.WRONG, "what the user trusts does not run: the decoy is none"))
        elif canary.exists() and not self.trap.runs:
            wrong.append(Fault(kinds.RAN, f"{canary.read_text()[:300]}: {said.complaint[:200]}"))
        return Found(str(said), tuple(wrong), {"received files": 1.0})


def environment(bench: Path, folder: Path) -> dict[str, str]:
    """A user's own settings in ``folder``, and the caches of all trials."""
    return {
        CANARY: str(bench / "canary"),
        "XDG_CONFIG_HOME": str(folder / ".config"),
        "XDG_CACHE_HOME": str(bench / ".cache"),
        "MPLCONFIGDIR": str(bench / ".matplotlib"),
    }


@cache
def honest(bench: Path) -> Path:
    """A run folder whose results are all fresh."""
    made = bench / "honest"
    made.mkdir()
    said = answer(("validate", *HONEST), made, SECONDS, environment(bench, made))
    assert said.code in BORNE, said.err
    return made / "tree"


def trials(seed: int) -> list[Trial]:
    """All of them."""
    return [*_opened(seed), *poisoned.trials(seed), *archives.trials(seed)]


PART = Part(
    "received",
    "A colleague mailed a model file, a run folder, a recording or an archive, or prepared the cache. Each "
    "brings code that writes a file when it runs. Controls show that it does run where the user trusts it.",
    (kinds.RAN, kinds.WRONG, kinds.HALF, kinds.TRACEBACK, kinds.UNCLEAR, kinds.HANGS),
    trials,
)


def _opened(seed: int) -> Iterator[Opened]:
    for trap in TRAPS:
        for command, more in TAKE.items():
            if trap.runs and command not in RUN:
                continue
            yield Opened("model files", trap, (command, *QUICK, *more, MODEL), seed)
    for name, files in RUN_FOLDER.items():
        for command, words in GO_ON.items():
            trap = Trap(name, files, codes=BORNE)
            yield Opened("run folders", trap, (command, *words), seed, honest=True)
    here = Trap("names of libraries where one stands", HERE, codes=BORNE)
    for words in ANYWHERE:
        yield Opened("the folder where one stands", here, words, seed, anew=True)
    job = Trap("a job file", JOB, codes=BORNE)
    yield Opened("jobs of a sweep", job, ("sweep", *QUICK, "sweep.job=theirs/job.json"), seed)
    for name, files in DATA.items():
        suffix = Path(next(iter(files))).suffix
        case = {"lab/case/mine.yaml": CASE.replace("swing.csv", f"swing{suffix}")}
        yield Opened("recordings", Trap(name, {**files, **case}), ("fit", *OWN), seed)
    yield from _named_by_the_user(seed)


def _named_by_the_user(seed: int) -> Iterator[Opened]:
    """Whether what the user names does run: else no trial could fail."""
    trap = next(trap for trap in TRAPS if trap.name == "a plant in its folder")
    named = Trap("control: named by --config-dir", trap.files, codes=BORNE, runs=True)
    for command in RUN:
        words = (command, *QUICK, *TAKE[command], MODEL, "--config-dir", "theirs")
        yield Opened("model files", named, words, seed)
