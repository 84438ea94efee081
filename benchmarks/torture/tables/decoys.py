"""Code that writes a file when it runs: the one that ``TORTURE_CANARY`` names."""

from __future__ import annotations

import os
import pickle
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.torture.case import REFUSED, Content

CANARY = "TORTURE_CANARY"
LINE = f"import os; open(os.environ[{CANARY!r}], 'a').write(__file__)\n"
SHELL = f'touch "${CANARY}"'
DECOY = f"""{LINE}
from hybridid.effects.friction import VISCOUS as EFFECT
from hybridid.plants.emps import EMPS
from hybridid.rigs.emps import EMPSRig
PLANT = EMPS()
"""
"""A module that could be taken for a plant, an effect or a rig."""
IN_C = f"""
#include <stdlib.h>
#include <stdio.h>
__attribute__((constructor)) static void run(void) {{
    FILE *file = fopen(getenv("{CANARY}"), "a");
    if (file) fclose(file);
}}
"""
"""A library that runs when it is loaded."""


class Bomb:
    """Runs a command when it is unpickled."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.system, (SHELL,)


@dataclass(frozen=True)
class Trap:
    """``files`` are those of a folder ``theirs`` and of the folder in which the user stands. ``before`` are
    commands that the user gives first; then ``changed`` are written. ``codes`` are the exit codes that are
    right; ``runs`` says that the code does run, because the user agreed."""

    name: str
    files: Mapping[str, Content]
    before: tuple[tuple[str, ...], ...] = ()
    changed: Mapping[str, Content] = field(default_factory=dict)
    codes: tuple[int, ...] = REFUSED
    says: tuple[str, ...] = ()
    runs: bool = False


def compiled(path: Path) -> None:
    """The decoy as machine code: an extension module, or any library."""
    source = path.with_suffix(".c")
    source.write_text(IN_C, encoding="utf-8")
    subprocess.run(["cc", "-shared", "-fPIC", str(source), "-o", str(path)], check=True)
    source.unlink()


def pickled(path: Path) -> None:
    """The decoy as a pickle."""
    path.write_bytes(pickle.dumps(Bomb()))
