"""The folder that the documentation builds, with recordings of a pendulum and a tank, simulated here."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import odeint

from pipelines.shared.own_code import make_importable

Array = NDArray[np.float64]
DOCS = Path(__file__).parents[3] / "docs"


class Bench:
    """The pendulum of the pages, with its true parameters: ``alone``, and with the ``cable`` of one's own."""

    alone: ClassVar = {"J": 0.02, "G": 0.9, "pivot.viscous.f_v": 0.015, "pivot.coulomb.f_c": 0.03}
    cable: ClassVar = {**alone, "pivot.cable.k_3": 0.08}
    dt, samples, epsilon = 0.005, 2000, 0.01

    def held(self, generator: np.random.Generator, size: float) -> Array:
        """A random torque that changes each 50th sample."""
        return np.repeat(generator.uniform(-size, size, self.samples // 50), 50)

    def swung(
        self,
        truth: Mapping[str, float],
        torque: Callable[[int, float], float],
        samples: int = samples,
        start: float = 0.3,
        hand: Mapping[int, float] | None = None,
    ) -> Array:
        """The angle at each sample. ``torque(k, angle)`` acts until the next; a hand holds some angles."""
        J, G, f_v, f_c, k_3 = [*truth.values(), 0.0][:5]

        def motion(_: float, x: Array, u: float) -> list[float]:
            resisting = f_v * x[1] + f_c * np.tanh(x[1] / self.epsilon) + k_3 * x[0] ** 3
            return [x[1], (u - G * np.sin(x[0]) - resisting) / J]

        x, angle, hand = np.array([start, 0.0]), np.empty(samples), hand or {}
        for k in range(samples):
            if k in hand:
                x = np.array([hand[k], 0.0])
            angle[k], u = x[0], torque(k, x[0])
            if k not in hand:
                x = odeint(motion, x, (0, self.dt), (u,), tfirst=True, rtol=1e-9, atol=1e-11)[-1]
        return angle

    def write(self, path: Path, torque: Array, angle: Array, **more: Array) -> None:
        """As the rig's sensors give it: ms, A and backward degrees."""
        time = 1e3 * self.dt * np.arange(len(angle))
        columns = np.column_stack([time, torque / 0.05, -np.rad2deg(angle), *more.values()])
        header = ",".join(["t_ms", "current", "angle_deg", *more])
        np.savetxt(path, columns, delimiter=",", header=header, comments="", fmt="%.12g")


@pytest.fixture(scope="session")
def bench() -> Bench:
    return Bench()


@pytest.fixture(scope="session")
def page() -> Callable[[str], str]:
    """``page("trace.md")``: the text of a page."""
    return lambda name: (DOCS / name).read_text()


@pytest.fixture(scope="session")
def blocks(page: Callable[[str], str]) -> Callable[..., list[str]]:
    """``blocks("trace.md")``: the blocks of code on a page."""
    return lambda name, language="python": re.findall(rf"(?s)```{language}\n(.*?)```", page(name))


@pytest.fixture(scope="session")
def write_files(page: Callable[[str], str]) -> Callable[[str, Path], set[str]]:
    """``write_files(name, folder)`` writes the files that a page shows; returns what they are called."""

    def write(name: str, folder: Path) -> set[str]:
        files = re.findall(r"(?ms)^`(mylab/\S+)`\n\n```\w+\n(.*?)```", page(name))
        for place, text in files:
            (folder / place).parent.mkdir(parents=True, exist_ok=True)
            (folder / place).write_text(text)
        return {place.removeprefix("mylab/") for place, _ in files}

    return write


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory, write_files: Callable[[str, Path], set[str]]) -> Path:
    """The folder with the files of the page on writing one's own."""
    root = tmp_path_factory.mktemp("docs")
    assert write_files("write-your-own.md", root) == {
        "pendulum.py", "case/pendulum.yaml", "grease.py", "swing_control.py", "tank.py", "case/tank.yaml"
    }  # fmt: skip
    return root


@pytest.fixture
def laboratory(built: Path, monkeypatch: pytest.MonkeyPatch, nothing_imported: None) -> Path:
    """One stands beside ``mylab``, whose modules can be imported."""
    monkeypatch.chdir(built)
    make_importable([built / "mylab"])
    return built


@pytest.fixture
def fit(say: Callable) -> Callable:
    """``fit(*words, out=...)`` types ``hybridid fit`` there, without MLflow."""
    return lambda *words, out: say("fit", *words, f"out={out}", "mlflow.enabled=false")


@pytest.fixture
def printed(laboratory: Path, capsys: pytest.CaptureFixture[str]) -> Callable[[str], str]:
    """``printed(code)``: what Python code prints there."""

    def run(code: str) -> str:
        capsys.readouterr()
        exec(code, {"__name__": "__main__"})
        return capsys.readouterr().out

    return run
