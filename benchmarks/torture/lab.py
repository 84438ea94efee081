"""The example lab that every case starts from: a pendulum of the user's own, with a good recording."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PLANT = Path(__file__).with_name("pendulum.py").read_text(encoding="utf-8")
CASE = """# @package _global_
case: {title: a pendulum of our own}
plant: pendulum:Pendulum
effects: [viscous]
signals:
  time: {column: t}
  inputs: {torque: {column: torque, unit: N·m, hold: zoh}}
  outputs: {angle: {column: angle, unit: rad}}
records:
  swing: {files: swing.csv, role: identification}
"""
DT, SAMPLES = 0.02, 150
FOLDER = functools.partial(Path.mkdir, parents=True)
"""Writes a folder where a file should be."""
OWN = ("--config-dir", "lab", "case=mine", "mlflow.enabled=false", "out=tree")
"""What each command line about the lab ends with."""


def lab(folder: Path) -> None:
    """Fill ``folder`` with the lab: in ``lab`` a recording, in ``lab/case`` the case and its plant."""
    (folder / "lab" / "case").mkdir(parents=True)
    (folder / "lab" / "case" / "mine.yaml").write_text(CASE, encoding="utf-8")
    (folder / "lab" / "case" / "pendulum.py").write_text(PLANT, encoding="utf-8")
    (folder / "lab" / "swing.csv").write_text(csv(swing()), encoding="utf-8")


@functools.cache
def swing() -> Array:
    """Time [s], torque [N·m] and angle [rad] of the true pendulum, (n, 3)."""
    generator = np.random.default_rng(1)
    torque = np.repeat(generator.uniform(-1.0, 1.0, SAMPLES // 10), 10)
    rows, (q, w) = [], (0.2, 0.0)
    for n in range(SAMPLES):
        rows.append((DT * n, torque[n], q))
        for _ in range(20):
            w += DT / 20 * (torque[n] - 0.9 * np.sin(q) - 0.03 * w) / 0.02
            q += DT / 20 * w
    return np.array(rows)


def csv(rows: Array, header: str = "t,torque,angle") -> str:
    """Rows of numbers as CSV."""
    lines = (",".join(f"{value:.9g}" for value in row) for row in rows)
    return "\n".join([header, *lines]) + "\n"


def fit(*words: str, command: str = "fit") -> Sequence[str]:
    """The words of a command about the lab."""
    return (command, *OWN, *words)
