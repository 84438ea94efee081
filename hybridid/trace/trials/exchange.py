"""Another effect in the place of an accepted one, with all parameters refitted."""

from __future__ import annotations

from collections.abc import Mapping

from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.rules import Rules
from hybridid.trace.trials.alike import leaves_little_more, look_alikes, tells_apart
from hybridid.trace.trials.smoothed_apart import smoothed_apart
from hybridid.trace.trials.trial import Trial


def exchanged(
    final: Refit, name: str, candidate: Candidate, split: Split, lent: Mapping[str, float] | None = None
) -> Refit | None:
    """``final`` with ``candidate`` in the place of the effect ``name``, refitted from its declared starts.

    ``lent`` are parameter values of another model with it, to start from (None: at its declared guess). None
    where ``final`` has ``candidate``, or the model cannot be simulated.
    """
    if candidate.name in {term.name for term in final.model.terms}:
        return None
    model = candidate.added_to(final.model.without(name))
    others = values_without(final, name)
    starts = candidate.starts(model, others)
    if lent is not None:
        own = {key: value for key, value in lent.items() if key.startswith(f"{candidate.name}.")}
        starts = [*starts[:-1], {**others, **own}]
    return refit_if_possible(model, split, starts, final, final.numerics)


def still_alike(
    final: Refit, one: Trial, rival: Trial, split: Split, rules: Rules, at_noise: bool = False
) -> bool:
    """Whether ``rival``, in the place of the accepted ``one``, explains the records as well in ``final``,
    which may leave no more than the noise (``at_noise``). The rules are those of ``equivalents``."""
    lent = rival.refit.values if rival.refit else {}
    other = exchanged(final, one.candidate.name, rival.candidate, split, lent)
    if other is None:
        return False
    if not tells_apart(compare(other.score, final.score), rules):
        return True
    more = other.score.loss**2 - final.score.loss**2
    near = more < rules.tie * one.taken and leaves_little_more(other, final, rules, at_noise)
    return (near and look_alikes(one, rival)) or smoothed_apart(final, other, split, rules)
