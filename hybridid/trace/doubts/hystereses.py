"""Several accepted hystereses, or relaxations, at one port may be the parts of a sum, and no names.

A sum of elastic and friction elements approximates any hysteresis without a memory of the speed. So where two
look-alikes with inner states and a limited effort were accepted at one port, the machine has one hysteresis
of another form. (A load behind a play or a spring has states, too, but no limited effort.)

A sum of Maxwell elements approximates any linear relaxation in the same way, also one of a fractional order.

A mass behind a spring and a Maxwell element at one port are together one mechanical impedance, the ratio of
effort to velocity there. Networks of masses, springs and dampers that have one impedance are equivalent: no
experiment at the port tells one from another.

Sources: Iwan (1966), A distributed-element model for hysteresis and its steady-state dynamic response, ASME
J. Applied Mechanics 33(4), 893-900; Findley, Lai, Onaran (1976), Creep and Relaxation of Nonlinear
Viscoelastic Materials, ch. 5; Smith (2002), Synthesis of mechanical networks: the inerter, IEEE Trans.
Autom. Control 47(10), 1648-1662.
"""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.effects.dimension import EFFORT
from hybridid.effects.effect import Effect
from hybridid.effects.elastic import MAXWELL
from hybridid.effects.inertia import FLEXIBLE_MODE
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.trace.search.steps import Accepted
from hybridid.trace.trials.alike import look_alikes

LINEAR = (MAXWELL.dynamics, FLEXIBLE_MODE.dynamics)
"""Of effects whose effort follows the motion linearly, with a memory."""
BRANCHES = 3
"""Maxwell branches at one port from which that is told."""


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


def spread_relaxation(model: Model) -> str:
    """That the Maxwell branches at a port may stand for one relaxation that is spread over time, in words;
    empty where the ``model`` has fewer than ``BRANCHES`` at each."""
    branches = [term for term in model.terms if term.effect.dynamics is MAXWELL.dynamics]
    ports = dict.fromkeys(term.port for term in branches)
    told = [port for port in ports if sum(term.port == port for term in branches) >= BRANCHES]
    if not told:
        return ""
    return (
        f" Beware: the Maxwell branches at {listed(told)} may stand for a relaxation that is spread over all "
        "times, as of rubber. Then their numbers depend on the frequencies in the records, and what was "
        "accepted beside them may be a part of it."
    )


def one_impedance(accepted: Sequence[Accepted]) -> str:
    """That a mass behind a spring and Maxwell elements at one port are one impedance, in words; empty where
    no two are."""
    linear = [one for one in accepted if one.trial.candidate.effect.dynamics in LINEAR]
    ports = dict.fromkeys(one.trial.candidate.port for one in linear)
    for port in ports:
        parts = [one for one in linear if one.trial.candidate.port == port]
        if len({one.trial.candidate.effect.dynamics for one in parts}) > 1:
            return (
                f" Beware: {listed([one.name for one in parts])} are together one mechanical impedance. "
                "Other networks of masses, springs and dampers have the same, so no experiment there tells "
                "whether the machine holds these."
            )
    return ""


def _is_hysteresis(effect: Effect) -> bool:
    """Whether it has inner states, and an amplitude that is the effort up to which it can rise."""
    return bool(effect.states) and any(p.nests and p.dimension == EFFORT for p in effect.parameters)
