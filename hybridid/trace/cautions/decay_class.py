"""In a free decay, friction over the amplitude and friction over the time cannot be told apart.

In a decay that nothing drives, the amplitude A falls with the time t alone: A = a(t), which has an inverse. A
friction that takes the power P(A) then takes the same power as one that takes P(a(t)). The record gives one
such curve. It cannot show on which of the two the friction depends, however well the parameters are
determined. Held-out horizons of the same decay lie on the same curve, so they do not tell either.

A machine that runs down in one direction takes each speed once, at one time and at one place. There any
effort may depend on each of the three, whatever its form. Some then cannot be told from what is declared,
either: they belong to the class all the same.

A law over time depends on the time itself, or on a state whose memory is longer than a swing. Only laws that
follow the velocity are compared: those take power. A spring changes the frequency, so it is not confused
with friction.

Several laws over the amplitude may be needed in the place of one over the time. The first three powers of the
amplitude are dry, viscous and drag friction, so these are tried together. Source: Feeny, Liang (1996), A
decrement method for the simultaneous estimation of Coulomb and viscous friction, J. Sound and Vibration
195(1), 149-154; with the next power.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import casadi as ca

from hybridid.advice.decay import free_decay, swing
from hybridid.advice.relaxation import relaxation
from hybridid.effects.dimension import TIME
from hybridid.effects.effect import Effect, Local
from hybridid.effects.library import effect_named
from hybridid.naming import listed
from hybridid.records.record import Record
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.learned.separable import law_symbols
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.trial import PASSED, Trial

POWERS = ("coulomb", "viscous", "quadratic_drag")
"""Frictions whose decrement falls as the powers 0, 1 and 2 of the amplitude."""


TOGETHER = "together with the others of the class, in the place of what was accepted"
"""Why one of ``POWERS`` is in a class that the search did not put it in."""


def with_decay_classes(found: Search, records: Sequence[Record], context: Context) -> Search:
    """``found``; if ``records`` are one free decay, with each accepted friction in a class of those that the
    decay cannot tell from it. Where they run down in one direction, these are all efforts of its step that
    explain at least half as much.

    In a decay these are the frictions that passed in its step at its port, if one of them follows the time
    and the other does not. If any accepted one follows the time, they are also those of ``POWERS``, where
    these together explain the records as well as all that were accepted.
    """
    if not found.accepted:
        return found
    if not list(free_decay(records)):
        return _of_a_relaxation(found, context.rules) if list(relaxation(records)) else found
    period = max(swing(record) for record in records)
    frictions = [one for one in found.accepted if takes_power(one.trial.candidate.effect)]
    slow = [one for one in frictions if over_time(one.trial, period)]
    powers = _powers(found, frictions, slow[0].trial.candidate.port, context) if slow else []
    widened = {one.name: _widened(found, one, powers, period) for one in frictions}
    return replace(found, accepted=tuple(widened.get(one.name, one) for one in found.accepted))


def _of_a_relaxation(found: Search, rules: Rules) -> Search:
    """``found`` with each accepted effort in a class of those at its port that gain as significantly in its
    step, determined or not, and take at least half as much."""
    widened = []
    for one in found.accepted:
        step = next(s for s in found.steps if any(taken.name == one.name for taken in s.taken))
        others = [t for t in step.trials if t.candidate.ports == one.trial.candidate.ports]
        members = {t.candidate.name: t for t in (one.trial, *one.alike)}
        for trial in others:
            shown = trial.p_adjusted <= rules.alpha and not trial.not_shown
            if shown and trial.candidate.effect.kind == "effort" and 2 * trial.taken >= one.trial.taken:
                members.setdefault(trial.candidate.name, trial)
        widened.append(replace(one, alike=tuple(members.values())))
    return replace(found, accepted=tuple(widened))


def _powers(found: Search, frictions: Sequence[Accepted], port: str, context: Context) -> list[Trial]:
    """Those of ``POWERS`` that the model lacks at ``port``, in the place of ``frictions``; none if together
    they explain less."""
    final = found.final
    model = final.model
    for one in frictions:
        model = model.without(one.name)
    nothing = {p.name: final.values[p.name] for p in model.parameters}
    present, added = dict(nothing), []
    for candidate in (Candidate(effect_named(name), port) for name in POWERS):
        if candidate.name not in {term.name for term in model.terms}:
            nothing = candidate.starts(model, nothing)[0]
            present = candidate.starts(model, present)[-1]
            model = candidate.added_to(model)
            added.append(candidate)
    given = (model, context.split, [nothing, present], final, final.numerics)
    other = context.one(refit_if_possible, *given)
    if other is None:
        return []
    advantage = compare(other.score, final.score)
    if advantage.gain >= context.rules.tie and advantage.p_value <= context.rules.alpha:
        return []
    gain = compare(found.first.score, other.score)
    return [Trial(one, other, gain, p_adjusted=gain.p_value, status=PASSED, reason=TOGETHER) for one in added]


def in_their_place(found: Search) -> str:
    """Which of ``POWERS`` together explain the records as well as the accepted frictions do; else empty."""
    powers: dict[str, None] = {}
    for one in found.accepted:
        powers |= dict.fromkeys(t.candidate.effect.id for t in one.alike if t.reason == TOGETHER)
    frictions = [one.trial.candidate.effect for one in found.accepted]
    if not powers:
        return ""
    replaced = listed([effect.id for effect in frictions if takes_power(effect)])
    together = "explain" if len(powers) > 1 else "explains"
    return f" In the place of {replaced}, {listed(list(powers))} {together} these records as well."


def _widened(found: Search, one: Accepted, powers: Sequence[Trial], period: float) -> Accepted:
    slow = over_time(one.trial, period)
    passed = (trial for trial in _passed(found, one) if over_time(trial, period) is not slow)
    members = {one.name: one.trial}
    for trial in (*powers, *passed, *one.alike):
        members.setdefault(trial.candidate.name, trial)
    return replace(one, alike=tuple(members.values()))


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
    at = law_symbols(effect)
    followed = ca.vertcat(effect.law(at), *_rates(effect, at))
    return bool(ca.depends_on(followed, at.velocity))


def over_time(trial: Trial, period: float) -> bool:
    """Whether the law of ``trial`` follows the time, or a state with a memory longer than ``period`` s."""
    effect = trial.candidate.effect
    at = law_symbols(effect)
    if ca.depends_on(ca.vertcat(effect.law(at), *_rates(effect, at)), at.time):
        return True
    memories = [p.name for p in effect.parameters if p.dimension is TIME] if effect.states else []
    values = trial.own("values") if trial.refit is not None else {}
    return any(values.get(name, 0.0) > period for name in memories)


def _rates(effect: Effect, at: Local) -> list[ca.SX]:
    return list(effect.dynamics(at).values()) if effect.dynamics else []
