"""Are the rigs' parameters found again where the truth is the declared model? Simulated.

The virtual eSEA with each of its four frictions, and the virtual vehicle, hold exactly what the gray box
declares: only the sensors are not ideal. Each is recorded with noise drawn anew, prepared and fitted as
``hybridid fit`` would with the case's own files, from guesses scattered about the case's by up to a factor
of ``SCATTER`` either way. Printed are truth, estimate, stated 95 % interval (``1.96 std``) and whether it
holds the truth; its half width says whether the interval is worth having.

    python benchmarks/recovery.py [--draws 6] [--seed 0] [--only lugre ...]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from benchmarks import studies
from hybridid.estimators import fit
from hybridid.model import Model
from hybridid.rigs.esea import F_C, F_S, F_V, SIGMA_0, SIGMA_1, V_S
from hybridid.rigs.half_car_truth import HalfCarTruth
from hybridid.signals.steps import apply_steps
from hybridid_cli.composing import settings_of
from pipelines.shared.config import Settings
from pipelines.shared.modelling import fit_settings, model_of
from pipelines.shared.sources import sources_of

Z95 = 1.96
SCATTER = 1.5
CAR = HalfCarTruth()


@dataclass(frozen=True)
class Case:
    """A rig that is as declared: the words of its command, and its ``truth`` in the model's names."""

    name: str
    words: tuple[str, ...]
    truth: dict[str, float]


def _esea(friction: str, **truth: float) -> Case:
    rig = f"rig.path=hybridid.rigs.esea:AS_DECLARED_{friction.upper()}"
    named = {f"motor.{name.replace('__', '.')}": value for name, value in truth.items()}
    return Case(friction, ("case=esea", f"friction={friction}", rig), named)


# The rig's own parameters in the effects': s = f_c / sigma_0, tau_b = sigma_1 / sigma_0, r_s = f_s / f_c - 1.
CASES = (
    _esea("linear", viscous__f_v=0.01),
    _esea(
        "coulomb_stribeck", viscous__f_v=F_V, coulomb__f_c=F_C, stribeck__df_s=F_S - F_C, stribeck__v_s=V_S
    ),
    _esea("dahl", dahl__f_c=F_C, dahl__s=F_C / SIGMA_0),
    _esea(
        "lugre",
        viscous__f_v=F_V,
        lugre__f_c=F_C,
        lugre__s=F_C / SIGMA_0,
        lugre__tau_b=SIGMA_1 / SIGMA_0,
        lugre__r_s=F_S / F_C - 1,
        lugre__v_s=V_S,
    ),
    Case(
        "half_car",
        ("case=vehicle", "rig.path=hybridid.rigs.half_car:AS_DECLARED"),
        {name: getattr(CAR, name) for name in ("I_yy", "k_f", "k_r", "c_f", "c_r", "k_t")},
    ),
)


@dataclass(frozen=True)
class Row:
    """One parameter of one draw, in its unit."""

    case: str
    seed: int
    parameter: str
    unit: str
    true: float
    estimate: float
    std: float
    status: str
    seconds: float

    @property
    def inside(self) -> bool:
        """Whether the stated 95 % interval holds the truth."""
        return abs(self.estimate - self.true) <= Z95 * self.std

    @property
    def width(self) -> float:
        """The interval's half width over the truth."""
        return Z95 * self.std / abs(self.true)


def configured(case: Case, seed: int) -> Settings:
    """The case's own config, its rig as declared, noise from ``seed``."""
    return settings_of([*case.words, "data=simulated", f"rig.seed={seed}"])


def scattered(model: Model, seed: int) -> Model:
    """``model`` with each free guess moved by up to a factor ``SCATTER`` either way, inside its bounds."""
    generator, moved = np.random.default_rng(seed), dict(model.adjustments)
    for p in model.free:
        guess = p.guess * SCATTER ** generator.uniform(-1.0, 1.0)
        inside = float(np.clip(guess, p.lower, p.upper))
        moved[p.name] = {"guess": inside, "lower": p.lower, "upper": p.upper}
    return replace(model, adjustments=moved)


def study(case: Case, seed: int) -> list[Row]:
    """One draw: record, prepare, fit, compare."""
    settings = configured(case, seed)
    source = next(s for s in sources_of(settings).found if s.role == "identification")
    record = apply_steps(source.record(), settings["preprocess.steps"])
    began = time.process_time()
    found = fit(scattered(model_of(settings), seed), [record], fit_settings(settings))
    seconds = time.process_time() - began
    return [
        Row(case.name, seed, p.name, p.unit, case.truth[p.name], p.value, p.std, found.status, seconds)
        for p in found.parameters
    ]


def table(rows: Sequence[Row]) -> str:
    """Markdown: every draw, then the share of each case and parameter."""
    header = ("case", "seed", "parameter", "true", "estimate", "95 % interval", "inside", "unit")
    draws = [
        (
            r.case, r.seed, r.parameter, f"{r.true:.5g}", f"{r.estimate:.5g}",
            f"± {Z95 * r.std:.2g} ({r.width:.1%})", "yes" if r.inside else "NO", r.unit,
        )
        for r in rows
    ]  # fmt: skip
    shares = []
    for name in dict.fromkeys(r.case for r in rows):
        own = [r for r in rows if r.case == name]
        widest = max(own, key=lambda r: r.width)
        seconds = np.median([r.seconds for r in own])
        inside = f"{sum(r.inside for r in own)} of {len(own)}"
        shares.append((name, inside, f"{widest.width:.1%} ({widest.parameter})", f"{seconds:.1f}"))
    shares.append(("all", f"{sum(r.inside for r in rows)} of {len(rows)}", "", ""))
    lead = "Simulated: the truth is the declared model, the sensors are the rig's."
    columns = ("case", "inside", "widest half width", "CPU s a fit")
    return "\n".join([lead, "", *studies.table(header, draws), "", *studies.table(columns, shares)])


def main(arguments: Sequence[str] | None = None, say: Callable[[str], None] = print) -> list[Row]:
    """Run the study from the command line's ``arguments`` and write it to ``outputs/studies``."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--draws", type=int, default=6, help="noise draws a case (default: 6)")
    parser.add_argument("--seed", type=int, default=0, help="of the first draw (default: 0)")
    parser.add_argument("--only", nargs="+", choices=[case.name for case in CASES], help="cases to run")
    given = parser.parse_args(arguments)
    rows: list[Row] = []
    for case in CASES:
        for seed in (
            range(given.seed, given.seed + given.draws) if case.name in (given.only or case.name) else ()
        ):
            made = study(case, seed)
            rows += made
            inside = sum(r.inside for r in made)
            say(
                f"{case.name}, seed {seed} (simulated): {inside} of {len(made)} inside, "
                f"{made[0].status}, {made[0].seconds:.1f} s CPU"
            )
    say(table(rows))
    studies.write(studies.OUT / "recovery.md", table(rows))
    plain = [{**asdict(r), "inside": r.inside} for r in rows]
    data = {"provenance": "simulated", "rows": plain}
    studies.write(studies.OUT / "recovery.json", json.dumps(data, indent=1))
    return rows


if __name__ == "__main__":
    main()
