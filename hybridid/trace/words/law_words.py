"""A proposed law in words."""

from __future__ import annotations

from collections.abc import Sequence
from operator import attrgetter

from hybridid.effects.composed import FORMS
from hybridid.naming import counted, listed
from hybridid.quantities import share
from hybridid.trace.entries import AcceptedEffect
from hybridid.trace.results.result import Trace
from hybridid.trace.search.steps import WITHDRAWN
from hybridid.trace.words.remarks import equation_in_words, parameters_in_words

MANY = 5
"""Laws that do as well as the proposed one and are told by their names, those with a form of the library
first."""


def proposed(laws: Sequence[AcceptedEffect]) -> str:
    """``The law proposed at carriage is F = k |v| (k = ...)``."""
    said = [f"at {one.port} is {_law(one)}" for one in laws]
    return f"The law proposed {said[0]}" + "".join(f"; the law proposed {more}" for more in said[1:])


def _law(entry: AcceptedEffect) -> str:
    """A composed law with its parameters and the laws that do as well."""
    text = f"{equation_in_words(entry)} ({', '.join(parameters_in_words(entry.parameters))})"
    if entry.form_of:
        text += f", which is the form of {entry.form_of}"
    others = [member.effect for member in entry.class_members if member.effect != entry.effect]
    if not others:
        return text
    named = [f"{one} (the form of {FORMS[one]})" for one in others if one in FORMS]
    others = named + [one for one in others if one not in FORMS]
    more = len(others) - MANY
    told = [*others[:MANY], counted(more, "other")] if more > 0 else others
    return f"{text}; these records cannot tell it from {listed(told)}"


def nearest_law(found: Trace) -> str:
    """Which refused law takes most of the error, and with which numbers; empty if none takes most of its
    square. Its form is not that of what is missing, so it is no proposal, but it shows where that acts."""
    laws = [one for one in (*found.rejected, *found.refused_laws) if one.is_law and one.parameters]
    most = max(laws, key=attrgetter("gain"), default=None)
    if most is None or 1.0 - (1.0 - most.gain) ** 2 < found.rules.majority:
        return ""
    known = ", ".join(parameters_in_words(most.parameters))
    return (
        f" Of the formulas tried {most.name} comes nearest: it takes {share(most.gain)} ({known}), and is no "
        f"proposal, as its form is not shown (hybridid effects {most.effect} prints it)."
    )


def in_place_of(found: Trace) -> str:
    """Which effects were accepted before a law took their place; empty if none did."""
    if not found.in_place_of:
        return ""
    first = listed(found.in_place_of)
    return f" {first} passed first; the law alone explains more, or as much with fewer parameters."


def passed_before(laws: Sequence[AcceptedEffect], found: Trace) -> str:
    """Which effect of the library with the form of a proposed law, or of one that does as well, passed before
    it was withdrawn, and why; empty if none did."""
    ids = (member.effect for law in laws for member in law.class_members)
    forms = {FORMS[one] for one in ids if one in FORMS}
    withdrawn = [e for e in found.rejected if e.effect in forms and e.reason.startswith(WITHDRAWN)]
    return "".join(
        f" {one.name} passed, but is no sure name: {one.reason.removeprefix(WITHDRAWN + ': ')}."
        for one in withdrawn
    )
