"""Amplitude and time are one in a free decay, so friction laws over the one and over the other are one class.

In a decay that nothing drives, the amplitude A falls with the time t alone: A = a(t), which has an inverse. A
friction that takes the power P(A) then takes the same power as one that takes P(a(t)). The record gives one
such curve. Which of the two it follows is no question that it can answer, however well the parameters are
determined. Held-out horizons of the same decay lie on the same curve, so they do not tell either.

A law over time depends on the time itself, or on a state whose memory is longer than a swing. Only laws that
follow the velocity are compared: those take power. A spring changes the frequency, and the decay does not
confuse it with friction.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from types import SimpleNamespace

import casadi as ca

from hybridid.advice.decay import free_decay, swing
from hybridid.effects.dimension import TIME
from hybridid.effects.effect import Effect, Local
from hybridid.records.record import Record
from hybridid.trace.search import Accepted, Search
from hybridid.trace.trial import PASSED, Trial


def with_decay_classes(found: Search, records: Sequence[Record]) -> Search:
    """``found``; if ``records`` are one free decay, with each accepted friction beside those that passed in
    its step at its port, if one of them follows the time and the other does not."""
    if not found.accepted or not list(free_decay(records)):
        return found
    period = max(swing(record) for record in records)
    return replace(found, accepted=tuple(_widened(found, one, period) for one in found.accepted))


def _widened(found: Search, one: Accepted, period: float) -> Accepted:
    if not takes_power(one.trial.candidate.effect):
        return one
    slow = over_time(one.trial, period)
    others = [t for t in _passed(found, one) if over_time(t, period) is not slow]
    return replace(one, alike=(*one.alike, *others))


def _passed(found: Search, one: Accepted) -> Iterator[Trial]:
    """The other frictions that passed at the port of ``one`` in the step that accepted it."""
    known = {trial.candidate.name for trial in one.alike} | {other.name for other in found.accepted}
    for step in found.steps:
        if any(taken.name == one.name for taken in step.taken):
            for trial in step.trials:
                same = trial.candidate.ports == one.trial.candidate.ports
                fresh = trial.status == PASSED and trial.candidate.name not in known
                if fresh and same and takes_power(trial.candidate.effect):
                    yield trial


def takes_power(effect: Effect) -> bool:
    """Whether the effect resists as the velocity says: its law, or what drives its states."""
    if effect.kind != "effort":
        return False
    at = _symbols(effect)
    followed = ca.vertcat(effect.law(at), *_rates(effect, at))
    return bool(ca.depends_on(followed, at.velocity))


def over_time(trial: Trial, period: float) -> bool:
    """Whether the law of ``trial`` follows the time, or a state with a memory longer than ``period`` s."""
    effect = trial.candidate.effect
    at = _symbols(effect)
    if ca.depends_on(ca.vertcat(effect.law(at), *_rates(effect, at)), at.time):
        return True
    memories = [p.name for p in effect.parameters if p.dimension is TIME] if effect.states else []
    values = trial.own("values") if trial.refit is not None else {}
    return any(values.get(name, 0.0) > period for name in memories)


def _symbols(effect: Effect) -> Local:
    """All that a law may use, as symbols."""
    names = ("time", "epsilon", "position", "velocity", "acceleration", "signal", "drive", "load", "level")
    return Local(
        p=SimpleNamespace(**{p.name: ca.SX.sym(p.name) for p in effect.parameters}),
        z=SimpleNamespace(**{s.name: ca.SX.sym(s.name) for s in effect.states}),
        channels=SimpleNamespace(**{name: ca.SX.sym(name) for name in effect.channels}),
        **{name: ca.SX.sym(name) for name in names},
    )


def _rates(effect: Effect, at: Local) -> list[ca.SX]:
    return list(effect.dynamics(at).values()) if effect.dynamics else []
