"""Several accepted hystereses at one port are the parts of a sum, and no names.

A sum of elastic and friction elements approximates any hysteresis without a memory of the speed. So where two
look-alikes with inner states and a limited effort were accepted at one port, the machine has one hysteresis
of another form. (A load behind a play or a spring has states, too, but no limited effort.)

Source: Iwan (1966), A distributed-element model for hysteresis and its steady-state dynamic response, ASME J.
Applied Mechanics 33(4), 893-900.
"""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.effects.dimension import EFFORT
from hybridid.effects.effect import Effect
from hybridid.naming import listed
from hybridid.trace.alike import look_alikes
from hybridid.trace.steps import Accepted


def several_hystereses(accepted: Sequence[Accepted]) -> str:
    """That hystereses at one port are the parts of a sum, in words; empty where no two are."""
    found = [one for one in accepted if _is_hysteresis(one.trial.candidate.effect)]
    parts = [
        one.name
        for one in found
        if any(
            other is not one
            and other.trial.candidate.port == one.trial.candidate.port
            and look_alikes(one.trial, other.trial)
            for other in found
        )
    ]
    if not parts:
        return ""
    return (
        f" Beware: {listed(parts)} look alike. Their sum stands for one hysteresis of another form, and none "
        "of them is a name."
    )


def _is_hysteresis(effect: Effect) -> bool:
    """Whether it has inner states, and an amplitude that is the effort up to which it can rise."""
    return bool(effect.states) and any(p.nests and p.dimension == EFFORT for p in effect.parameters)
