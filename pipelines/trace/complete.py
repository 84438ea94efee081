"""The completeness check: a network beside each model, and whether it still finds anything.

The network is the learned effort that gains most on held-out horizons: radial basis functions over the
velocity or the position of a port, fitted in simulation together with all physical parameters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hybridid.trace.ceiling import BUMPS, Ceiling
from hybridid.trace.mapper import Mapper
from hybridid.trace.rules import Rules
from hybridid.trace.search import Report
from pipelines.trace.proof import WITH_NETWORK, Ask, Proof, scored


@dataclass(frozen=True)
class Completed:
    """Metrics rows of one model with the network beside it."""

    network: Ceiling
    rows: tuple[dict[str, Any], ...]


def completed(
    proofs: Sequence[Proof],
    ceilings: Sequence[Sequence[Ceiling]],
    parts: tuple[Sequence[Any], Sequence[Any]],
    ask: Ask,
    mapper: Mapper,
    report: Report,
) -> list[Completed]:
    """Each proved model with its best network, on the fitted and the other records of ``parts``; empty
    where the plant has no effort port."""
    if not all(ceilings):
        return []
    best = [max(found, key=lambda c: c.gain) for found in ceilings]
    places = [
        (WITH_NETWORK.format(proof.name), one.refit.model, one.refit.values, *parts, ask)
        for proof, one in zip(proofs, best, strict=True)
    ]
    made: list[Completed] = []
    for one, (rows, _) in zip(best, mapper(scored, places), strict=True):
        made.append(Completed(one, rows))
        report("with a network", len(made), len(places), places[len(made) - 1][0])
    return made


def completeness(found: Sequence[Completed], rules: Rules) -> Mapping[str, Any] | None:
    """Whether the network finds more beside the last model, as ``trace.json`` says it."""
    if not found:
        return None
    last = found[-1].network
    complete = last.gain < rules.worth or last.p_value > rules.alpha
    return {
        "network": f"{BUMPS} radial basis functions over {last.over} at {last.port}, beside all parameters",
        "gain": last.gain,
        "p_value": last.p_value,
        "complete": complete,
        "gain_before": found[0].network.gain,
    }
