"""The completeness check: a network beside each model, and whether it still finds anything.

The network is the learned effort or flow that gains most on held-out horizons: radial basis functions over
the velocity, the position, the level or the time at a port, fitted in simulation together with all physical
parameters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from hybridid.trace.context import Context
from hybridid.trace.doubts.settled import Ceilings
from hybridid.trace.learned.ceiling import Ceiling, ceilings_at, strongest
from hybridid.trace.learned.promising_efforts import most_promising, promising
from hybridid.trace.results.before_after import FittedModel, ScoreRow, Validation, scored
from hybridid.trace.rules import Rules
from hybridid.trace.verdict import Conclusion

WITH_NETWORK = "{} + network"
"""What a model is called with the network beside it."""


@dataclass(frozen=True, eq=False)
class WithNetwork:
    """A model with its strongest learned effort beside it, and its scores so."""

    network: Ceiling
    rows: tuple[ScoreRow, ...]


@dataclass(frozen=True)
class Completeness:
    """What a network still takes from the held-out error.

    ``gain`` is the relative decrease of the held-out RMSE by ``network`` beside the last model, with its
    ``p_value``; ``gain_before`` that by ``network_before``, the strongest one beside the declared model.
    ``complete``: what is left is not worth having, or not
    significant.
    """

    network: str
    gain: float
    p_value: float
    complete: bool
    gain_before: float
    network_before: str


def ceilings_of_each(found: Conclusion, context: Context) -> tuple[Ceilings, ...]:
    """The learned efforts beside the declared model and, if anything was accepted, beside the last one. If
    the former served no decision, only the most promising ones are fitted, after a time limit three."""
    if not found.accepted:
        return (found.ceilings,)
    if found.ceilings_before:
        return found.ceilings_before, found.ceilings
    first, every = found.search.first, [(one.port, one.over) for one in found.ceilings]
    late = found.out_of_time
    chosen = promising(every, first, context, math.inf) if late else most_promising(every, first, context)
    stage = "learned effort beside the declared model"
    return ceilings_at(every, chosen, first, context, stage), found.ceilings


def with_networks(
    models: Sequence[FittedModel], found: Sequence[Ceilings], validation: Validation, context: Context
) -> list[WithNetwork]:
    """Each of ``models`` with its strongest learned effort; empty without an effort or flow port."""
    if not all(found):
        return []
    networks = [strongest(of_model) for of_model in found]
    places = [
        (WITH_NETWORK.format(one.name), network.refit.model, network.refit.values, validation, True)
        for one, network in zip(models, networks, strict=True)
    ]
    results = context.each("with a network", scored, places, lambda result: result[0][0].model)
    return [WithNetwork(network, rows) for network, (rows, _) in zip(networks, results, strict=True)]


def completeness(found: Sequence[WithNetwork], rules: Rules) -> Completeness | None:
    """Whether the network finds more beside the last model; None where there is no network."""
    if not found:
        return None
    first, last = found[0].network, found[-1].network
    return Completeness(
        network=_described(last),
        gain=last.gain,
        p_value=last.p_value,
        complete=not last.passes(rules),
        gain_before=first.gain,
        network_before=_described(first),
    )


def _described(one: Ceiling) -> str:
    return f"{one.over.bumps} radial basis functions over {one.over} at {one.port}"
