"""The servo of ``case=servo`` as a stranger writes it, from a template, beside the packaged case. Measured.

The words of ``hybridid new`` and the changed lines are those of the section "Beyond a template" of
docs/your-machine.md: this study makes them.
"""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.strangers.command import DATA, ROOT, beyond, commanded, python_in
from hybridid.estimators.estimate import Estimate
from pipelines.shared.fitted import fit_of
from pipelines.shared.predictions import metric_rows

PAGE = ROOT / "docs" / "your-machine.md"
RECORDS = "bam_xl330"
ALLOWED = 25
"""Lines beyond the template that are allowed."""
SAME = ("k_t", "R_s", "q_0", "joint.viscous.f_v", "joint.coulomb.f_c")
"""Parameters that both fit by the same name."""


@dataclass(frozen=True)
class Servo:
    """Both servos, measured. ``python`` and ``case`` count the lines beyond what ``new`` wrote.
    ``parameters`` and ``rmse`` [rad, by record, of free runs] hold ours and that of the packaged case."""

    commands: int
    python: int
    case: int
    wall: tuple[float, ...]
    cpu: tuple[float, ...]
    parameters: Mapping[str, tuple[float, float]]
    rmse: Mapping[str, tuple[float, float]]

    @property
    def apart(self) -> float:
        """The largest relative difference of a parameter or an error."""
        pairs = (*self.parameters.values(), *self.rmse.values())
        return max(abs(ours - theirs) / (abs(theirs) or 1.0) for ours, theirs in pairs)


def records() -> Path | None:
    """The measured records, if they are at hand."""
    home = os.environ.get(DATA)
    found = Path(home) / RECORDS if home else None
    return found if found and found.is_dir() else None


def said_on_page() -> tuple[list[str], str, str]:
    """The words of ``new``, and the changed lines of the plant's file and of the case."""
    text = PAGE.read_text(encoding="utf-8")
    section = text[text.index("## Beyond a template") : text.index("## How long it takes")]
    (new,) = (line for line in section.splitlines() if line.startswith("hybridid new"))
    plant, case = re.findall(r"```diff\n(.*?)```", section, flags=re.DOTALL)
    return shlex.split(new)[1:], plant, case


def edited(block: str, text: str) -> str:
    """``text`` with the lines of a diff changed as they say.

    Raises:
        ValueError: if what is to be changed does not stand there once.
    """
    for part in block.strip("\n").split("\n\n"):
        lines = part.splitlines()
        old = "\n".join(line[1:] for line in lines if not line.startswith("+"))
        if text.count(old) != 1:
            raise ValueError(f"stands {text.count(old)} times: {old}")
        text = text.replace(old, "\n".join(line[1:] for line in lines if not line.startswith("-")))
    return text


def played(measured: Path, folder: Path) -> Servo:
    """Write the servo by ``new`` and the page's changes, and validate it and the packaged case."""
    (folder / RECORDS).symlink_to(measured.resolve())
    words, plant, case = said_on_page()
    (pattern,) = (word for word in words if "*" in word)
    k = words.index(pattern)
    files = sorted(str(path.relative_to(folder)) for path in folder.glob(pattern))
    new = commanded((*words[:k], *files, *words[k + 1 :]), folder)
    name = words[1]
    settings = folder / name / "case" / f"{name}.yaml"
    before, template = python_in(folder / name), {"case": settings.read_text().splitlines()}
    for file, block in ((folder / name / f"{name}.py", plant), (settings, case)):
        file.write_text(edited(block, file.read_text()))
    ours = commanded(("validate", "--config-dir", name, f"case={name}", "mlflow.enabled=false"), folder)
    theirs = ("validate", "case=servo", f"paths.data={measured.resolve().parent}", "mlflow.enabled=false")
    commanded(theirs, folder)
    trees = [folder / "outputs" / one / "latest" for one in (name, "servo")]
    scores = [_free_runs(tree) for tree in trees]
    return Servo(
        2,
        beyond(before, python_in(folder / name)),
        beyond(template, {"case": settings.read_text().splitlines()}),
        (new.wall, ours.wall),
        (new.cpu, ours.cpu),
        _parameters(*(fit_of(tree).estimate for tree in trees)),
        {record: (scores[0][record], scores[1][record]) for record in sorted(scores[1])},
    )


def _parameters(ours: Estimate, theirs: Estimate) -> dict[str, tuple[float, float]]:
    """What both fitted. Our inertia is that of motor and pendulum together."""
    mine, packaged = ({one.name: one.value for one in fit.parameters} for fit in (ours, theirs))
    whole = packaged["J"] + theirs.known["m"] * theirs.known["l"] ** 2
    found = {name: (mine[name], packaged[name]) for name in SAME}
    return {"J": (mine["J"], whole), **found, "cost": (ours.cost, theirs.cost)}


def _free_runs(tree: Path) -> dict[str, float]:
    """RMSE of the free run of the fitted model in rad, by record."""
    rows = [row for row in metric_rows(tree) if row.view == "free_run"]
    return {row.record: row.rmse for row in rows}
