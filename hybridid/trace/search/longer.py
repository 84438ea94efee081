"""Whether a model that meets the noise over short horizons does so over longer ones, too.

The initial state of each horizon is fitted. What a missing effort does to the motion grows from there on:
over a horizon of a few samples it may stay within the noise, whatever is missing. A complete model leaves the
noise over horizons of any length, if its parameters are fitted over these. So before nothing is said to be
missing, the last model is fitted and judged over longer horizons, up to ten times as long, of which enough
are left on either side. Where none are, it is fitted to the fitted records alone over horizons twice as long:
what is left even then, parameters that noise has moved do not explain. An epsilon of sign(v) that was chosen
over the short horizons is fitted as well, if that leaves no more than the noise.

A model that is unstable lets any disturbance grow. So horizons over which it grows by more than e to the
power of ``GROWS`` show the disturbance, and nothing else: they are not asked.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from hybridid.advice.horizon import GROWS
from hybridid.model import Model
from hybridid.simulation.windows import cut
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import FEW, FEWEST, Split
from hybridid.trace.mapper import unheard
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.noise_floor.input_noise import noisy_inputs
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.finer_steps import in_short_steps
from hybridid.trace.search.sharper import free_widths, sharp_enough
from hybridid.trace.starts.solve import declared_refit
from hybridid.validation.drift import growth

LEAST = 20
"""Samples of a horizon below which its fitted initial state may follow what a missing effort does."""
MOSTLY_NOISE = 2**0.5
"""Times what noise and simulation leave up to which they make up at least half of the squared error."""
TIMES = (10.0, 5.0, 3.0, 2.0)
"""How much longer the horizons are, where enough are left."""


@dataclass(frozen=True)
class Longer:
    """Over horizons of ``seconds`` a model leaves ``times`` what noise and simulation alone leave: on the
    held-out ones, or where too few are held out for it to be ``judged`` there, on the fitted ones."""

    seconds: float
    times: float
    judged: bool = True


def more_over_longer(final: Refit, context: Context, above: float | None = None) -> Longer | None:
    """What ``final`` leaves over longer horizons, if that is more than ``above`` (None: ``Rules.far``) times
    what noise and simulation alone leave there; None also where longer horizons are too few, or cannot be
    simulated.

    The longest decide whether it does. Told are the longest over which it does and of which ``FEW`` are left
    on either side; else the shortest, as more of these can judge.
    """
    above = context.rules.far if above is None else above
    judged = _bounded(_longer(context.split), final)
    splits = judged or _bounded(_of_the_fitted(context.split), final)
    longest = _more_over(splits[0], final, context, above) if splits else None
    if longest is None:
        return None
    enough = [one for one in splits if min(len(one.fitted), len(one.held_out)) >= FEW]
    found = (
        longest if one is splits[0] else _more_over(one, final, context, above)
        for one in enough or reversed(splits)
    )
    return replace(next(filter(None, found), longest), judged=bool(judged))


def _bounded(splits: Sequence[Split], final: Refit) -> list[Split]:
    """Those of ``splits`` over whose horizons a disturbance of ``final``'s model does not grow too far."""
    values = final.model.values(final.values)
    rates = ((one, growth(final.model, values, one.records)) for one in splits)
    return [one for one, rate in rates if rate * one.horizon * one.records[0].dt <= GROWS]


def _more_over(split: Split, final: Refit, context: Context, above: float) -> Longer | None:
    """What ``final`` leaves over the horizons of ``split``, if more than ``above`` times the noise."""
    times = _left_over(split, final, context)
    if times is None or times <= above or _left_by_the_smoothing(split, final, context, above):
        return None
    return Longer(split.horizon * split.records[0].dt, times)


def _left_over(split: Split, final: Refit, context: Context) -> float | None:
    """How many times the noise the model of ``final`` leaves, fitted over the horizons of ``split``. A fit
    that has not converged says nothing: over long horizons the cost of a machine that sticks may be rough."""
    found = _fitted_over(split, final, context)
    if found is None or not found.converged:
        return None
    return Accuracy.of(found, replace(context, split=split)).times(found.score.rmse)


def _fitted_over(split: Split, final: Refit, context: Context) -> Refit | None:
    """The model of ``final`` fitted over the horizons of ``split``; kept, as several questions ask for it."""

    def fitted() -> Refit | None:
        begun = _begun_as(final, context.split, split)
        return context.one(refit_if_possible, begun.model, split, [begun.values], begun, begun.numerics)

    key = ("left over", tuple(final.values.items()), final.numerics, final.substeps, split)
    return final.model.kept(key, fitted)


def made_by_noise(longer: Longer, final: Refit, context: Context) -> bool:
    """Whether noise of an input may make all that the model of ``final`` leaves over the ``longer`` horizons.
    In a machine that integrates such noise adds up over them by itself, and a disturbance likewise."""
    split = as_long_as(longer, context.split)
    found, there = _fitted_over(split, final, context), replace(context, split=split)
    return found is not None and noisy_inputs(found, Accuracy.of(found, there), there) is not None


def _left_by_the_smoothing(split: Split, final: Refit, context: Context, above: float) -> bool:
    """Whether no more than ``above`` times the noise is left with the epsilons fitted as well. What a machine
    that creeps shows of them over short horizons may be too inexact for longer ones: the moment at which it
    breaks away decides where it is from then on."""
    if not (free := free_widths(final.model)):
        return False
    model = replace(final.model, adjustments={**final.model.adjustments, **free})
    values = {name: value for name, value in final.values.items() if name not in free}
    times = _left_over(split, replace(final, model=model, values=values), context)
    return times is not None and times <= above


def _begun_as(final: Refit, split: Split, longer: Split) -> Refit:
    """``final`` with initial states of the horizons of ``longer``: those of the horizons of ``split`` that
    begin where these do, else those that the record shows.

    A long horizon that passes near an unstable rest, as a crank near its top, has one valley for each side.
    A horizon that ends before it has not, and its initial state leads to the right one.
    """
    known = dict(zip(_beginnings(split), final.x0, strict=True))
    shown = final.problem(longer).measured_x0()
    x0 = [known.get(place, one) for place, one in zip(_beginnings(longer), shown, strict=True)]
    return replace(final, x0=np.array(x0), cost=math.inf)


def _beginnings(split: Split) -> list[tuple[str, int]]:
    """Record and first sample of each horizon."""
    origins = cut(split.records, split.horizon, 1).origin
    return [(split.records[record].name, start) for record, start, _ in origins]


def over_long_enough(
    model: Model, context: Context, starts: Sequence[Mapping[str, float]], numerics: Numerics
) -> Context:
    """``context`` with longer horizons if what ``model`` leaves over its own is mostly noise, and over these
    is so far above the noise that a complete model could take what is worth having: a search over the short
    ones would see little of what is missing.

    What the simulation leaves grows over them as well, so its error is made small first, as it is before a
    search. A crank that creeps over its top where the real one passes is on the other side from then on.
    """
    base = declared_refit(model, context, starts, numerics)
    if Accuracy.of(base, context).times(base.score.rmse) > MOSTLY_NOISE:
        return context
    unsaid = replace(context, say=unheard)
    exact = sharp_enough(in_short_steps(base, unsaid), unsaid, declared=True)
    longer = more_over_longer(exact, context, worth_looking_for(context.rules))
    if longer is None or not longer.judged or made_by_noise(longer, exact, context):
        return context
    return lengthened(context, longer)


def worth_looking_for(rules: Rules) -> float:
    """Times what noise and simulation leave above which a complete model could take what is worth having."""
    return rules.near_floor / (1.0 - rules.worth)


def lengthened(context: Context, longer: Longer) -> Context:
    """``context`` with horizons as long as those of ``longer``, which is said."""
    context.say(
        f"over horizons of {longer.seconds:.2g} s the model leaves {longer.times:.1f} times what noise and "
        "simulation leave: the search goes on over these"
    )
    return replace(context, split=as_long_as(longer, context.split))


def as_long_as(longer: Longer, split: Split) -> Split:
    """``split`` in horizons as long as those of ``longer``."""
    return split.longer(round(longer.seconds / split.records[0].dt))


def shows_little(split: Split) -> bool:
    """Whether horizons are so short that they show little, and the records give no longer ones."""
    return split.horizon < LEAST and not _longer(split)


def _longer(split: Split) -> list[Split]:
    """Divided in the same way, in the longer horizons of which enough are left, the longest first."""
    found = []
    for times in TIMES:
        with suppress(ValueError):  # too few horizons
            found.append(split.longer(int(times * split.horizon)))
    return found


def _of_the_fitted(split: Split) -> list[Split]:
    """The fitted records alone, in horizons ``TIMES[-1]`` times as long, which are fitted and looked at; none
    if they are too few."""
    origins = cut(split.records, split.horizon, 1).origin
    records = tuple(split.records[k] for k in sorted({origins[h][0] for h in split.fitted}))
    samples = int(TIMES[-1] * split.horizon)
    every = tuple(range(len(cut(records, samples, 1).origin)))
    said = "fitted and looked at on the same horizons"
    return [Split(records, samples, every, every, said)] if len(every) >= FEWEST else []
