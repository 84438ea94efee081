"""Whether another way in which the inputs run between samples explains what is left of the error.

Where a record does not say how its inputs run between samples, that is assumed. Half a sample of delay may be
far more than the noise of a good sensor, and no effect of the machine makes up for it. So the last model is
refitted under each other hold.
"""

from __future__ import annotations

from hybridid.naming import listed
from hybridid.quantities import share
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.robustness import refitted_under, variations


def better_hold(final: Refit, context: Context) -> str:
    """The hold under which ``final`` explains the held-out horizons better, in words; empty if none does, or
    no more than noise is left."""
    if context.meets_noise(final.score):
        return ""
    records, rules = context.split.records, context.rules
    holds = [one for one in variations(records, final.numerics) if one.hold is not None]
    evidence = [
        (compare(final.score, other.score), how.hold)
        for how, other in zip(holds, refitted_under(final, holds, context), strict=True)
        if other is not None
    ]
    better = [(one, hold) for one, hold in evidence if rules.passes(one.gain, len(holds) * one.p_value)]
    if not better:
        return ""
    best, hold = max(better, key=lambda pair: pair[0].gain)
    assumed = [c for c in records[0].input_channels if c.assumed]
    names = listed([c.name for c in assumed])
    keys = listed([f"signals.inputs.{c.name}.hold={hold}" for c in assumed])
    runs = "run" if len(assumed) > 1 else "runs"
    return (
        f" Beware: how {names} {runs} between samples is not declared, and {assumed[0].hold} is assumed. "
        f"With {hold} the last model leaves {share(best.gain)} less. If that is how it was recorded, set "
        f"{keys} and trace again."
    )
