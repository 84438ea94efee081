"""Do the stated 95 % intervals hold the true parameters? A study on simulated carriages.

The EMPS of ``hybridid.rigs`` is run with known parameters, recorded with noise drawn anew, and
fitted over horizons of one second, as the default command does it. Counted is how often
``value ± 1.96 std`` holds the truth. Three truths of one machine:

- ``smooth``: friction exactly as the model writes it, tanh(v/epsilon), integrated by SciPy. Noise
  is all there is, so the part of std that is noise alone must hold the truth in 95 of 100 draws.
- ``loop``: the same, with the noise inside the control loop, so that the force answers it.
- ``dry``: the rig's own truth, which sticks. Smoothing sign(v) then moves every estimate; the
  stated error counts that, and noise alone does not.

    python benchmarks/interval_coverage.py [--draws 100] [--seed 0] [--processes 2] [--quick]
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import cache
from multiprocessing import get_context

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from benchmarks import studies
from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Record
from hybridid.rigs.emps import EMPSConfig, EMPSRig, EMPSTruth

Array = NDArray[np.float64]
TRUTH = EMPSTruth(M=95.0, f_v=203.0, f_c=20.4, offset=-3.2)
EFFECTS = ("viscous", "coulomb", "offset")
EPSILON = EMPS().port("carriage").epsilon
DT = 1e-3
HORIZON = 1000
Z95 = 1.96


@dataclass(frozen=True)
class Case:
    """One kind of noise on one kind of truth; ``memory`` [s] is the noise's correlation time, 0 if white."""

    name: str
    truth: str
    std: float
    memory: float = 0.0


CASES = (
    Case("white", "smooth", 5e-6),
    Case("slow", "smooth", 5e-6, 0.02),
    Case("white in the loop", "loop", 1e-6),
    Case("slow in the loop", "loop", 1e-6, 0.02),
    Case("white, true sticking", "dry", 5e-6),
)


@dataclass(frozen=True)
class Draw:
    """Errors and standard errors of one fit by parameter; ``noise`` is std less its part for smoothing."""

    error: list[float]
    std: list[float]
    noise: list[float]
    converged: bool


@dataclass(frozen=True)
class Row:
    """One parameter of one case over all draws, in its unit."""

    case: str
    parameter: str
    unit: str
    held: float
    held_by_noise_alone: float
    scatter: float
    bias: float
    mean_std: float
    median_noise_std: float


def noise(case: Case, n: int, generator: np.random.Generator) -> Array:
    """Sensor noise in m, (n,): white, or a stationary first-order autoregression."""
    rho = np.exp(-DT / case.memory) if case.memory else 0.0
    before = int(10 * case.memory / DT)
    white = generator.normal(size=n + before) * case.std * np.sqrt(1 - rho**2)
    return lfilter([1.0], [1.0, -rho], white)[before:]


def measure(case: Case, duration: float, seed: int) -> Record:
    """The carriage as one draw of noise shows it, simulated."""
    generator = np.random.default_rng(seed)
    n = round(duration / DT) + 1
    if case.truth == "loop":
        return _smooth(duration, noise(case, n, generator))
    clean = _dry(duration) if case.truth == "dry" else _without_noise(duration)
    return replace(clean, outputs=clean.outputs + noise(case, n, generator)[:, None], warnings=())


@cache
def _dry(duration: float) -> Record:
    return EMPSRig(EMPSConfig(truth=TRUTH)).record("identification", 0, duration)


@cache
def _without_noise(duration: float) -> Record:
    return _smooth(duration, np.zeros(round(duration / DT) + 1))


def _smooth(duration: float, sensed: Array) -> Record:
    """The rig's experiment on a carriage whose friction is tanh(v/epsilon), by SciPy's LSODA; the control
    sees the noise ``sensed``."""
    config, clean = EMPSConfig(truth=TRUTH), _dry(duration)
    reference, n = config.reference.position(clean.time), clean.n
    state, measured, force = np.zeros(2), np.zeros(n), np.zeros(n)
    previous = oldest = sensed[0]

    def rate(_: float, x: Array, u: float) -> list[float]:
        friction = TRUTH.f_v * x[1] + TRUTH.f_c * np.tanh(x[1] / EPSILON) + TRUTH.offset
        return [x[1], (u - friction) / TRUTH.M]

    for k in range(n):
        measured[k] = state[0] + sensed[k]
        command = config.controller.command(reference[k], (measured[k], previous, oldest), DT)
        force[k] = config.drive.gain * config.drive.voltage(command)
        solved = solve_ivp(rate, (0, DT), state, "LSODA", args=(force[k],), rtol=1e-8, atol=1e-12)
        state, previous, oldest = solved.y[:, -1], measured[k], previous
    return replace(clean, inputs=force[:, None], outputs=measured[:, None], warnings=())


def study(case: Case, duration: float, seed: int) -> Draw:
    """One draw: simulate, fit, compare."""
    found = fit(compose(EMPS(), EFFECTS), [measure(case, duration, seed)], FitSettings(horizon=HORIZON))
    parameters = found.parameters
    return Draw(
        error=[p.value - getattr(TRUTH, p.name.split(".")[-1]) for p in parameters],
        std=[p.std for p in parameters],
        noise=[float(np.sqrt(max(p.std**2 - p.smoothing**2, 0.0))) for p in parameters],
        converged=found.converged,
    )


def rows(case: Case, draws: Sequence[Draw]) -> list[Row]:
    """What the draws of one case say, a row for each parameter."""
    error, std, alone = (np.array([getattr(d, k) for d in draws]) for k in ("error", "std", "noise"))
    model = compose(EMPS(), EFFECTS)
    return [
        Row(
            case=case.name,
            parameter=p.name,
            unit=p.unit,
            held=float(np.mean(np.abs(error[:, k]) <= Z95 * std[:, k])),
            held_by_noise_alone=float(np.mean(np.abs(error[:, k]) <= Z95 * alone[:, k])),
            scatter=float(error[:, k].std(ddof=1)),
            bias=float(error[:, k].mean()),
            mean_std=float(std[:, k].mean()),
            median_noise_std=float(np.median(alone[:, k])),
        )
        for k, p in enumerate(model.free)
    ]


def table(found: Sequence[Row], draws: int) -> str:
    """Markdown."""
    low, high = (stats.binom.ppf(q, draws, 0.95) / draws for q in (0.025, 0.975))
    lead = (
        f"Share of {draws} draws whose stated 95 % interval holds the truth (simulated). "
        f"If it is 95 %, 95 % of such shares lie in {low:.0%} to {high:.0%}."
    )
    header = (
        "noise", "parameter", "stated", "noise alone", "mean error", "scatter", "mean std", "noise part",
        "unit",
    )  # fmt: skip
    cells = [
        (
            row.case, row.parameter, f"{row.held:.0%}", f"{row.held_by_noise_alone:.0%}", f"{row.bias:.3g}",
            f"{row.scatter:.3g}", f"{row.mean_std:.3g}", f"{row.median_noise_std:.3g}", row.unit,
        )
        for row in found
    ]  # fmt: skip
    return "\n".join([lead, "", *studies.table(header, cells)])


def main(arguments: Sequence[str] | None = None, say: Callable[[str], None] = print) -> list[Row]:
    """Run the study from the command line's ``arguments`` and write it to ``outputs/studies``."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--draws", type=int, default=100, help="noise draws a case (default: 100)")
    parser.add_argument("--seed", type=int, default=0, help="of the first draw (default: 0)")
    parser.add_argument("--processes", type=int, default=2, help="at work at once (default: 2)")
    parser.add_argument("--duration", type=float, default=8.0, help="of each record in s (default: 8)")
    parser.add_argument("--quick", action="store_true", help="8 draws of 4 s: does it run?")
    given = parser.parse_args(arguments)
    count, duration = (8, 4.0) if given.quick else (given.draws, given.duration)
    found: list[Row] = []
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")  # the processes share the cores
    with ProcessPoolExecutor(given.processes, get_context("spawn")) as pool:
        for case in CASES:
            began = time.perf_counter()
            seeds = range(given.seed, given.seed + count)
            draws = list(pool.map(study, [case] * count, [duration] * count, seeds))
            found += rows(case, draws)
            failed, took = sum(not draw.converged for draw in draws), time.perf_counter() - began
            say(f"{case.name}: {count} simulated draws, {failed} not converged, {took:.0f} s")
    say(table(found, count))
    about = {"draws": count, "seed": given.seed, "duration_s": duration, "provenance": "simulated"}
    data = json.dumps({**about, "rows": [asdict(row) for row in found]}, indent=1)
    file = studies.write(studies.OUT / "coverage.json", data)
    say(f"written: {file}, {studies.write(studies.OUT / 'coverage.md', table(found, count))}")
    return found


if __name__ == "__main__":
    main()
