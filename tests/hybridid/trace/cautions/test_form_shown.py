"""How far another law may differ unseen: the rule that tells effects apart says so, and the words."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.trace.cautions.form_shown import form_hardly_shown, hidden_difference
from hybridid.trace.rules import Rules

TIE = Rules.tie


@pytest.mark.parametrize("gain", [0.06, 0.12, 0.3, 0.8])
def test_a_law_that_differs_by_more_would_be_told_from_it(gain):
    """Errors as a trace has them: noise, what the effect takes, and what it leaves of the true law's part."""
    rng = np.random.default_rng(1)
    part, other, noise = np.linalg.qr(rng.normal(size=(4000, 3)))[0].T
    left = 1.0 - gain  # of an RMSE of 1 without the effect
    taken = 1.0 - left**2
    hidden = hidden_difference(taken, left**2, TIE)
    for times, told in ((0.95, False), (1.05, True)):
        of_the_truth = np.sqrt(max(left**2 - (times * hidden) ** 2 * taken, 0.0))
        named = of_the_truth * noise + times * hidden * np.sqrt(taken) * other
        without = named + np.sqrt(taken) * part
        assert np.linalg.norm(without) == pytest.approx(1.0)
        assert np.linalg.norm(named) == pytest.approx(left)
        assert bool(1.0 - of_the_truth / np.linalg.norm(named) >= TIE) is told


def test_what_gains_nothing_or_all_has_the_extremes():
    assert hidden_difference(0.0, 1.0, TIE) == hidden_difference(-0.2, 1.0, TIE) == 1.0
    assert hidden_difference(0.01, 1.0, TIE) == 1.0
    assert hidden_difference(1.0, 0.0, TIE) == 0.0


def _accepted(name: str, gain: float, alike: int = 1, together: str = ""):
    trial = SimpleNamespace(taken=(1 - gain) ** -2 - 1)  # of an RMSE of 1 that is left
    return SimpleNamespace(name=name, trial=trial, alike=(trial,) * alike, together=together)


def test_only_single_effects_of_little_gain_are_told():
    sure, weak, weaker = (_accepted(f"p.{gain}", gain) for gain in (0.8, 0.12, 0.06))
    of_a_class, of_a_pair = _accepted("p.class", 0.06, alike=2), _accepted("p.pair", 0.06, together="p.weak")
    assert form_hardly_shown([sure, of_a_class, of_a_pair], 1.0, Rules()) == ""
    assert form_hardly_shown([sure, weak], 1.0, Rules()) == (
        " These records show that p.0.12 (37 %) is there, but little of its form: they cannot tell it "
        "from a law that differs in what it does to the outputs by that share."
    )
    assert form_hardly_shown([sure, weak], 0.5, Rules()) == "", "what was found later took the rest"
    assert "p.0.12 (37 %) and p.0.06 (55 %) are there, but little of their forms" in form_hardly_shown(
        [weak, weaker], 1.0, Rules()
    )
