"""The smoothing of sign(v) made narrower where it leaves a part of the error.

A machine that sticks does not creep as tanh(v/epsilon) does. Where the smoothing leaves an error, an effect
that creeps less (a bristle, a hysteresis) takes it, and seems to be missing. So before effects are tried
beside a model, it is refitted with half of each epsilon, and again, as long as that takes as much from the
held-out error as an effect must (``Rules.worth``). It is the simulation's error that goes: no law was added.

Source: Roache (1998), Verification and Validation in Computational Science and Engineering, ch. 3: the error
of a solution is made small before the model is judged.
"""

from __future__ import annotations

import math
from dataclasses import replace

from hybridid.declarations import Parameter
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.quantities import quantity
from hybridid.trace.context import Context
from hybridid.trace.entries import Width
from hybridid.trace.evidence import compare
from hybridid.trace.refit import Refit, refit_if_possible

MOST_HALVINGS = 4
"""Times that an epsilon is halved in one step: each doubles the steps that the integrator needs."""


def sharp_enough(base: Refit, context: Context) -> Refit:
    """``base``, or its refit over as narrow a smoothing as pays. An epsilon that the user has fixed stays."""
    for _ in range(MOST_HALVINGS):
        narrower, widths = _narrowed(base.model)
        if not widths:
            break
        values = {name: value for name, value in base.values.items() if name not in widths}
        given = (narrower, context.split, [values], base, base.numerics, math.inf)
        again = context.one(refit_if_possible, *given)
        if again is None or compare(base.score, again.score).gain < context.rules.worth:
            break
        base = again
        said = [f"{quantity(p.guess, p.unit)} ({p.name})" for p in _widths(narrower)]
        context.say(f"sign(v) is smoothed over {listed(said)} from here on: that leaves less error")
    return base


def narrowed(declared: Model, final: Model) -> tuple[Width, ...]:
    """The epsilons of ``final`` that are no longer those of its ports, or of the ``declared`` model."""
    before = {p.name: p.guess for p in replace(final, adjustments=declared.adjustments).parameters}
    return tuple(
        Width(p.name, p.unit, before[p.name], p.guess) for p in _widths(final) if p.guess != before[p.name]
    )


def _widths(model: Model) -> list[Parameter]:
    """The epsilons that are constants, and that the user has not fixed."""
    return [
        p
        for p in model.parameters
        if p.name.endswith(".epsilon") and p.fixed and "fixed" not in model.adjustments.get(p.name, {})
    ]


def _narrowed(model: Model) -> tuple[Model, dict[str, float]]:
    """``model`` with half of each epsilon that is not fixed by the user, and these halves by name."""
    widths = {p.name: p.guess / 2 for p in _widths(model)}
    changed = {name: {"guess": width} for name, width in widths.items()}
    return replace(model, adjustments={**model.adjustments, **changed}), widths
