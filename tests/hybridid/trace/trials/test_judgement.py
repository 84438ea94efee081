"""Where an effect loses its form, it is refused: a mode that is damped out is no mode."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.duffing import Duffing
from hybridid.trace.candidates import Candidate
from hybridid.trace.trials.judgement import _degenerate
from hybridid.trace.trials.trial import Trial

MODE = Candidate(effect_named("flexible_mode"), "oscillator")


@pytest.mark.parametrize(
    ("damping", "reason"),
    [(2.0, "zeta = 2 ends at its bound: the effect degenerates"), (1.9, ""), (1e-3, "")],
)
def test_a_mode_that_is_damped_out_is_no_mode(damping, reason):
    model = MODE.added_to(compose(Duffing()))
    values = {p.name: p.guess for p in model.parameters} | {f"{MODE.name}.zeta": damping}
    refit = SimpleNamespace(model=model, values=values, std={})
    assert _degenerate(Trial(MODE, refit, None)) == reason
