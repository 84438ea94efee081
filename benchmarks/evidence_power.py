"""How often does the evidence for a missing effect err, and how often does it see one? Simulated.

Errors of a model are drawn on a short record: white, coloured, heavy-tailed, or in bursts. A hundred
candidates are tried as a trace tries them: each is fitted on every other horizon and judged by
``hybridid.trace.horizons.evidence`` on the horizons between, all as one family, weighted by what each takes
from the fitted horizons (Holm). Here a candidate is one signal with one amplitude, so that its fit is a
division. It acts always, as a friction does, or now and then, as a limit does: in three stretches of a
fifteenth of the record.

- Nothing missing: no candidate is in the errors. Counted are the records on which any passes.
- One missing: the first candidate takes a share of the error. Counted are the records on which it passes.

With the horizons as units, with the blocks of ``hybridid.trace.horizons.score``, and with these where both
sides judge (``hybridid.trace.trials.cross_fitting``).

    python benchmarks/evidence_power.py [--draws 200] [--candidates 100] [--seed 0]
"""

from __future__ import annotations

import argparse
import csv
import os
from collections.abc import Callable, Mapping, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from benchmarks.studies import OUT
from hybridid.trace.horizons.evidence import compare, holm
from hybridid.trace.horizons.score import BLOCKS, Score, score_of
from hybridid.trace.horizons.split import automatic_horizon
from hybridid.trace.rules import Rules
from hybridid.trace.trials.cross_fitting import TESTS, joined

Array = NDArray[np.float64]
Generator = np.random.Generator
RATE = 100
"""Samples a second."""
SECONDS = (6, 12, 30, 60)
SHARES = (0.0, 0.1, 0.2)
"""By how much the RMSE falls without what the first candidate explains; 0: nothing is missing."""
UNITS: Mapping[str, int] = {"horizons": 1, "blocks": BLOCKS, "both sides": BLOCKS}


def _coloured(n: int, generator: Generator, memory: float) -> Array:
    """A first-order autoregression with the coefficient ``memory``, of unit variance, (n,)."""
    made = lfilter([1.0], [1.0, -memory], generator.normal(size=n + 500))[500:]
    return np.asarray(made * np.sqrt(1 - memory**2))


def _bursts(n: int, generator: Generator) -> Array:
    """White noise with short transients, about one in 3 s, eight times as high; of unit variance, (n,)."""
    made = generator.normal(size=n)
    shape = np.exp(-np.arange(40) / 10)
    for start in generator.integers(n - 40, size=max(2, n // 300)):
        made[start : start + 40] += 8 * generator.normal() * shape
    return made / made.std()


NOISES: Mapping[str, Callable[[int, Generator], Array]] = {
    "white": lambda n, generator: generator.normal(size=n),
    "coloured": lambda n, generator: _coloured(n, generator, 0.9),
    "heavy-tailed": lambda n, generator: generator.standard_t(3, size=n) / np.sqrt(3),
    "bursts": _bursts,
}


def p_values(errors: Array, candidates: Array, horizon: int, blocks: int, both: bool = False) -> list[float]:
    """p-value of each of ``candidates`` (c, n) in ``errors`` (n,), adjusted for all of them; ``both``: with
    either side fitted and judging."""
    rows = errors[: len(errors) // horizon * horizon].reshape(-1, horizon, 1)
    shapes = [signal[: rows.size].reshape(rows.shape) for signal in candidates]
    poorer = _score(rows, blocks)
    fitted = [_without(rows, shape, 0) for shape in shapes]
    scores = [_score(left, blocks) for left, _ in fitted]
    alone = holm([compare(poorer, score).p_value for score in scores], [taken for _, taken in fitted])
    if not both:
        return alone
    before = joined(poorer, _score(rows, blocks, 1))
    there = (_score(_without(rows, shape, 1)[0], blocks, 1) for shape in shapes)
    p_both = [compare(before, joined(*pair)).p_value for pair in zip(scores, there, strict=True)]
    return [min(1.0, TESTS * min(one, len(shapes) * other)) for one, other in zip(alone, p_both, strict=True)]


def _without(rows: Array, shape: Array, side: int) -> tuple[Array, float]:
    """``rows`` (h, n, 1) less what explains every other one, from number ``side`` on, best; and the share of
    these that it takes."""
    ours, signal = rows[side::2], shape[side::2]
    power, together = (signal**2).sum(), (signal * ours).sum()
    amplitude = together / power if power > 0 else 0.0
    return rows - amplitude * shape, float(amplitude * together / (ours**2).sum())


def _score(rows: Array, blocks: int, side: int = 0) -> Score:
    """The score on the other rows of what was fitted to every other one from number ``side`` on."""
    return score_of(list(rows[side::2]), list(rows[1 - side :: 2]), np.ones(1), blocks)


def _now_and_then(n: int, generator: Generator) -> Array:
    """Ones in three stretches, (n,), else zeros."""
    made, length = np.zeros(n), n // 15
    for start in generator.integers(n - length, size=3):
        made[start : start + length] = 1
    return made


ACTS: Mapping[str, Callable[[int, Generator], Array]] = {
    "always": lambda n, generator: np.ones(n),
    "now and then": _now_and_then,
}


def drawn(
    noise: str, acts: str, seconds: int, share: float, count: int, generator: Generator
) -> tuple[Array, Array]:
    """Errors (n,), and ``count`` candidates (count, n), of which the first explains ``share`` of the RMSE."""
    n = seconds * RATE
    memories = generator.uniform(0.5, 0.99, size=count)
    candidates = np.array([_coloured(n, generator, memory) * ACTS[acts](n, generator) for memory in memories])
    amplitude = np.sqrt(1 / (1 - share) ** 2 - 1) / candidates[0].std()
    return NOISES[noise](n, generator) + amplitude * candidates[0], candidates


def counted(
    noise: str, acts: str, seconds: int, share: float, draws: int, count: int, seed: int
) -> dict[str, float]:
    """Share of records on which a candidate passes, by unit: the first if there is one to find, else any."""
    generator, alpha = np.random.default_rng([seed, seconds, len(noise)]), Rules().alpha
    horizon = round(automatic_horizon([seconds], []) * RATE)
    passed = dict.fromkeys(UNITS, 0)
    for _ in range(draws):
        errors, candidates = drawn(noise, acts, seconds, share, count, generator)
        for unit, blocks in UNITS.items():
            found = p_values(errors, candidates, horizon, blocks, both=unit == "both sides")
            passed[unit] += (found[0] if share else min(found)) <= alpha
    return {unit: passed[unit] / draws for unit in UNITS}


def main(
    arguments: Sequence[str] | None = None, say: Callable[[str], None] = print
) -> list[dict[str, object]]:
    """Count, print the table and write it to ``outputs/studies``."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--draws", type=int, default=200)
    words.add_argument("--candidates", type=int, default=100)
    words.add_argument("--seed", type=int, default=0)
    given = words.parse_args(arguments)
    say(f"share of records on which a candidate passes (simulated, {given.draws} draws, seed {given.seed})")
    table = []
    for noise, acts, seconds, share in product(NOISES, ACTS, SECONDS, SHARES):
        found = counted(noise, acts, seconds, share, given.draws, given.candidates, given.seed)
        table.append({"noise": noise, "acts": acts, "seconds": seconds, "missing": share, **found})
        what = f"one takes {share:.0%}" if share else "nothing missing"
        units = ", ".join(f"{unit} {value:.1%}" for unit, value in found.items())
        say(f"  {noise:13} {acts:13} {seconds:3} s  {what:16} {units}")
    OUT.mkdir(parents=True, exist_ok=True)
    file = OUT / "evidence_power.csv"
    with file.open("w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, fieldnames=list(table[0]))
        writer.writeheader()
        writer.writerows(table)
    say(f"written to {os.path.relpath(file)}")
    return table


if __name__ == "__main__":
    main()
