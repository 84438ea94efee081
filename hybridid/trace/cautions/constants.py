"""Whether a constant that is declared as known explains what an effect was named for, or what none does.

A mass may have been weighed without its cable, a gear ratio taken from another data sheet. A search that
only adds effects gives such an error the name of one, or of several. So each fixed parameter of the plant is
freed, one at a time, between half and twice its value: in the place of each accepted effect, of all of them,
and where the verdict is ``unexplained``, beside the last model. It is told

- in the place of an effect, if the model with the effect shows no relevant advantage then (``tells_apart``),
- beside the last model, if it takes most of the squared error that is left (``Rules.majority``), at
  ``Rules.alpha`` among all constants,

and if it certainly ends elsewhere than declared, and at no bound.

The fit must have converged, and the standard error holds what the smoothing of sign(v) moves the constant by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from hybridid.declarations import Parameter
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.quantities import Z95, estimated, number, quantity, share
from hybridid.simulation.stability import TooStiff
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import CONTINUATION, FAILURES, refit
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Search
from hybridid.trace.trials.alike import tells_apart
from hybridid.trace.trials.constancy import with_smoothing
from hybridid.trace.verdict import Conclusion

FURTHEST = 2.0
"""Times its value, or its value over this, a constant may be: what differs more is other physics."""
TOLD, DIGITS = 3, 4
"""Constants and other parameters that are told in one place, at most, and the digits of the latter."""
BOUND = 1e-3
"""Share of a bound within which a constant ends there."""


@dataclass(frozen=True)
class Freed:
    """A ``constant`` that was freed ``instead`` of accepted effects (none: beside all), and what came of it;
    None where the model could not be simulated. ``more`` is the share of the held-out error that it takes
    beyond these, if that is worth having and significant. ``others`` tells the parameters that are other ones
    then."""

    constant: Parameter
    instead: tuple[str, ...]
    refit: Refit | None
    more: float = 0.0
    others: str = ""

    @property
    def name(self) -> str:
        """What was tried, in words."""
        place = f" in the place of {listed(self.instead)}" if self.instead else ""
        return f"{self.constant.name} free{place}"

    def moved(self, tests: int, alpha: float) -> bool:
        """Whether the fit converged, and the constant certainly ends elsewhere than declared, of so many
        ``tests``, and at no bound."""
        if self.refit is None or not self.refit.converged:
            return False
        declared = self.constant.guess
        value, std = self.refit.values[self.constant.name], self.refit.std.get(self.constant.name, 0.0)
        ratio = value / declared
        inside = (1 + BOUND) / FURTHEST < ratio < (1 - BOUND) * FURTHEST
        return bool(inside and 0 < norm.isf(alpha / (2 * tests)) * std < abs(value - declared))

    def __str__(self) -> str:
        assert self.refit is not None
        p, found = self.constant, self.refit
        return (
            f"{p.name} = {estimated(found.values[p.name], found.std.get(p.name), p.unit)} instead of "
            f"{number(p.guess, 5)}"
        )


@dataclass(frozen=True)
class WrongConstants:
    """Constants that explain as much ``in_place`` of accepted effects; those ``beside`` all, with what they
    take from the held-out error."""

    in_place: tuple[Freed, ...] = ()
    beside: tuple[tuple[Freed, float], ...] = ()


def wrong_constants(found: Conclusion, context: Context) -> WrongConstants:
    """Which declared constants explain as much as what was accepted, or most of what is unexplained."""
    final, rules = found.search.final, context.rules
    constants = _constants(final.model)
    names = tuple(one.name for one in found.accepted)
    places = [(name,) for name in names] + ([()] if found.verdict == "unexplained" else [])
    tried = _tried([(p, place, ()) for place in places for p in constants], found.search, context)
    if len(names) > 1:
        refits = {p.name: [one.refit for one in tried if one.constant == p and one.refit] for p in constants}
        tried += _tried([(p, names, tuple(refits[p.name])) for p in constants], found.search, context)
    moved = sorted((one for one in tried if one.moved(len(tried), rules.alpha)), key=_loss)
    as_much = [
        _with_more(one, final, rules) for one in moved if one.instead and not _worse(one, final, context)
    ]
    gains = ((one, _taken(one, final, len(constants), rules)) for one in moved if not one.instead)
    return WrongConstants(
        tuple(sorted(as_much, key=lambda one: -len(one.instead))),
        tuple((one, gain) for one, gain in gains if gain > 0),
    )


def _tried(
    asked: Sequence[tuple[Parameter, tuple[str, ...], tuple[Refit, ...]]], search: Search, context: Context
) -> list[Freed]:
    """Each constant that is ``asked``, freed in its place."""
    given = [(constant, place, known, search, context.split) for constant, place, known in asked]
    return context.each("declared constants", _freed, given, lambda one: one.name, always=0)


def constants_in_words(wrong: WrongConstants) -> str:
    """``wrong`` in words; empty if there is none. What takes the place of all is not told of each."""
    every = {place: [one for one in wrong.in_place if one.instead == place] for place in _places(wrong)}
    return "".join([*(_in_place(place, freed) for place, freed in every.items()), _beside(wrong.beside)])


def _places(wrong: WrongConstants) -> list[tuple[str, ...]]:
    places = list(dict.fromkeys(one.instead for one in wrong.in_place))
    return places[:1] if places and len(places[0]) > 1 else places


def _constants(model: Model) -> list[Parameter]:
    """The parameters of the plant that are declared as known, and that may be wrong by a share."""
    own = {p.name for p in model.plant.parameters}
    return [p for p in model.parameters if p.name in own and p.fixed and p.guess and not p.smooths]


@np.errstate(over="ignore", invalid="ignore")  # a start may diverge
def _freed(
    constant: Parameter, instead: tuple[str, ...], known: Sequence[Refit], search: Search, split: Split
) -> Freed:
    """``constant`` freed in the last model of ``search``, without the effects ``instead`` (none: with all),
    from where that ended, from where the declared model did, and from where the ``known`` refits did: these
    have it free beside more effects, and are nearer."""
    final, first = search.final, search.first
    model = final.model
    for name in instead:
        model = model.without(name)
    values = {p.name: final.values[p.name] for p in model.parameters}
    bounds = sorted((constant.guess / FURTHEST, constant.guess * FURTHEST))
    adjusted = {"guess": constant.guess, "lower": bounds[0], "upper": bounds[1]}
    free = replace(model, adjustments={**model.adjustments, constant.name: adjusted})
    starts = [
        {**values, **{key: value for key, value in one.values.items() if key in values}}
        for one in (final, first, *known)
    ]
    std_up_to = FURTHEST * final.score.loss
    try:
        found = refit(free, split, starts, final, final.numerics, CONTINUATION, std_up_to=std_up_to)
    except (TooStiff, *FAILURES):
        return Freed(constant, instead, None)
    return Freed(constant, instead, with_smoothing(found, split) if found.std else found)


def _worse(one: Freed, final: Refit, context: Context) -> bool:
    """Whether the model with the effect is shown to explain more than that with the constant free."""
    assert one.refit is not None
    return tells_apart(compare(one.refit.score, final.score), context.rules)


def _with_more(one: Freed, final: Refit, rules: Rules) -> Freed:
    assert one.refit is not None
    better = compare(final.score, one.refit.score)
    more = better.gain if rules.passes(better.gain, better.p_value) else 0.0
    return replace(one, more=more, others=_others(one.refit, final))


def _others(freed: Refit, final: Refit) -> str:
    """The parameters of ``final`` that certainly are other ones in the model ``freed``, those that move most,
    in words."""
    certain = [p for p in final.model.free if Z95 * freed.std.get(p.name, np.inf) < _moved(p, freed, final)]
    most = sorted(certain, key=lambda p: -_moved(p, freed, final) / abs(freed.values[p.name] or 1.0))
    return listed(
        [
            f"{p.name} is {quantity(freed.values[p.name], p.unit, DIGITS)} "
            f"instead of {quantity(final.values[p.name], p.unit, DIGITS)}"
            for p in most[:TOLD]
        ]
    )


def _moved(p: Parameter, freed: Refit, final: Refit) -> float:
    return abs(freed.values[p.name] - final.values[p.name]) if p.name in freed.values else 0.0


def _taken(one: Freed, final: Refit, tests: int, rules: Rules) -> float:
    """The share of the held-out error that a constant takes beside all; 0 if not most of its square, or not
    significantly among so many ``tests``."""
    assert one.refit is not None
    better = compare(final.score, one.refit.score)
    most = 1.0 - (1.0 - better.gain) ** 2 >= rules.majority
    return better.gain if most and tests * better.p_value <= rules.alpha else 0.0


def _in_place(place: tuple[str, ...], freed: Sequence[Freed]) -> str:
    """What explains as much in the place of the effects ``place``, in words."""
    some = listed([str(one) for one in freed[:TOLD]])
    each = ", each alone" if len(freed) > 1 else ""
    first = freed[0]
    more = f"more ({share(first.more)} less error)" if first.more else "as much"
    others = f"; then {first.others}" if first.others else ""
    assert first.refit is not None
    setting = f"parameters.{first.constant.name}.fixed={first.refit.values[first.constant.name]:.5g}"
    return (
        f" Beware: in the place of {listed(place)} a constant that is declared as known explains {more}, if "
        f"it has another value: {some}{each}{others}. To go on with that instead: {setting}."
    )


def _beside(freed: Sequence[tuple[Freed, float]]) -> str:
    if not freed:
        return ""
    told = listed([f"{one} takes {share(gain)} from the held-out error" for one, gain in freed[:TOLD]])
    each = "; each alone" if len(freed) > 1 else ""
    return (
        f" A constant that is declared as known may be wrong: {told}{each}. Compare that with what you know "
        "of the machine."
    )


def _loss(one: Freed) -> float:
    assert one.refit is not None
    return one.refit.score.loss
