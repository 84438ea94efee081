"""In words, what does better in the place of a declared effect, or as well with fewer parameters."""

from __future__ import annotations

from hybridid.naming import counted, listed
from hybridid.quantities import probability, share
from hybridid.trace.entries import ReplacedEffect
from hybridid.trace.results.result import Trace


def revised_in_words(found: Trace) -> str:
    """What explains more in the place of a declared effect, or as much with fewer parameters; empty unless
    that was asked and found."""
    if not found.replacements:
        return ""
    best = found.replacements[0]
    alike = [
        one.left_out
        for one in found.replacements
        if (one.kind, set(one.effects)) == (best.kind, set(best.effects))
        and best.gain - one.gain < found.rules.tie
    ]
    in_place = f" The declared {' or '.join(alike)} may be wrong: {listed(best.effects)} in its place "
    return in_place + (_as_good(best, found) if best.kind == "as_good" else _better(best))


def gained(one: ReplacedEffect) -> str:
    """What a replacement gains: less error, or as little with fewer parameters."""
    if one.kind == "better":
        return f"{share(one.gain)} less error"
    return f"as good with {counted(one.fewer, 'parameter')} fewer"


def _better(one: ReplacedEffect) -> str:
    leave = "leave" if len(one.effects) > 1 else "leaves"
    return f"{leave} {gained(one)} (p {probability(one.p_value, '= ')})."


def _as_good(one: ReplacedEffect, found: Trace) -> str:
    needless = [each.name for each in found.accepted if each.name not in one.effects]
    without = f", without {listed(needless)}" if needless else ""
    return (
        f"{'explain' if len(one.effects) > 1 else 'explains'} the records as well with "
        f"{counted(one.fewer, 'parameter')} fewer{without}. These records cannot tell the two models apart; "
        "the simpler one is preferred."
    )
