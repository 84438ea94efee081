"""One simulation with sensitivities against the arithmetic that it needs."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.speed.contest import Way, contest
from benchmarks.speed.emps import contested, like_emps
from benchmarks.speed.machine import cycles_a_second
from benchmarks.speed.row import OURS, Row
from hybridid.effects.library import effect_named
from hybridid.simulation.compiler import widest
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.windows import cut

SIMULATION = "one simulation with sensitivities"
AT_ONCE = 2
"""Instructions on a register of ``widest()`` numbers that a core of today begins in each cycle."""
ADDED = ((), ("dahl",), ("input_saturation",), ("cogging",))


def simulations(repeats: int, say: Callable[[str], None], quick: bool) -> Iterator[Row]:
    """25 horizons of 1 s of a simulated EMPS, with effects of several kinds."""
    record = like_emps(25_000)
    for added in ADDED[:1] if quick else ADDED:
        model = contested(1000, "data=simulated").model
        for name in added:
            model = model.plus(effect_named(name))
        shooter = Shooter(model, cut([record], 1000, 1), tuple(p.name for p in model.free))
        x0, p = np.zeros((shooter.windows.count, len(model.states))), model.values()
        what = " + ".join(("EMPS", *added))
        say(what)

        def run(shooter: Shooter = shooter, x0: np.ndarray = x0, p: np.ndarray = p) -> str:
            shot = shooter(x0, p, sensitivities=True)
            return f"{shot.by_parameter.shape[-1] + shot.by_state.shape[-1]} columns"

        (found,) = contest([Way(OURS, run)], max(repeats, 20), lambda line: None)
        operations = sum(part.operations for part in shooter.code.parts[:2]) * record.n / widest()
        least = operations / AT_ONCE / cycles_a_second()
        say(f"  {1e9 * found.median / record.n:.0f} ns a sample, arithmetic {1e9 * least / record.n:.0f}")
        yield Row(
            SIMULATION,
            what,
            OURS,
            found.seconds,
            f"{found.found}, {operations * widest() / record.n:.0f} operations a sample",
            "simulated",
            found.memory,
            least,
        )
