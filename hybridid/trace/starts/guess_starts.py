"""Where a refit starts if what is missing has bent the parameters: at the guesses.

A model that lacks an effect makes up for it with its parameters. Without Coulomb friction, an oscillator that
is driven slowly ends with a tenth of its mass and ten times its damping. From there a descent may not come
back: with so little mass the equations are stiff, and each step that helps leads to less mass still. The
guesses are not bent, as the engineer knows them from a drawing or a data sheet. So where the path of the
poorer model strays from the record, and a parameter of the plant has left the order of magnitude of its
guess, a refit begins with all of the plant's parameters at their guesses as well.
"""

from __future__ import annotations

from collections.abc import Mapping

from hybridid.model import Model
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit_starts import begun_at_the_record
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.shorter import strays

FAR = 3.0
"""Times a guess, or its inverse, beyond which a value is of another order of magnitude (half a decade)."""


def from_guesses(
    candidate: Candidate, model: Model, base: Refit, split: Split
) -> tuple[Mapping[str, float], Refit] | None:
    """Values to start the augmented ``model`` from, with the effect at zero, and ``base`` with the initial
    states that go with them; None where nothing has bent the parameters so far."""
    values = with_guesses(base)
    if values is None:
        return None
    return candidate.starts(model, values)[0], begun_at_the_record(base, values, split)


def with_guesses(base: Refit) -> dict[str, float] | None:
    """The values of ``base``, the plant's free parameters at their guesses; None where ``base`` does not
    stray, or has none far from its guess."""
    plant = {p.name for p in base.model.plant.parameters}
    guesses = {p.name: p.guess for p in base.model.free if p.name in plant}
    far = any(g and not 1 / FAR <= base.values[name] / g <= FAR for name, g in guesses.items())
    return {**base.values, **guesses} if far and strays(base) else None
