"""Two effects are told apart by the output that shows it, whatever the others add to the pooled error."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.trace.horizons.evidence import Comparison, compare
from hybridid.trace.horizons.score import score_of
from hybridid.trace.rules import Rules
from hybridid.trace.trials.alike import leaves_little_more, tells_apart

HORIZONS, LENGTH = 24, 100
SCALE = np.array([1.0, 1.0])
GOOD, POOR = 1e-4, 1e-2
"""Standard deviation of the noise of two sensors."""


def _scored(more: float):
    """A model that leaves the noise of both sensors, and in the good one a wave of ``more`` times that."""
    rng = np.random.default_rng(1)
    noise = rng.standard_normal((2, HORIZONS, LENGTH, 2)) * [GOOD, POOR]
    slow = np.sin(np.linspace(0, 6, LENGTH))[:, None] * [more * GOOD, 0.0]
    fitted, held_out = noise + slow
    return score_of(list(fitted), list(held_out), SCALE)


def test_a_poor_sensor_does_not_hide_what_a_good_one_shows():
    truth, rival = _scored(0.0), _scored(1.5)
    advantage = compare(rival, truth)
    assert advantage.gain < 1e-3, "the poor sensor makes all of the pooled error"
    assert advantage.largest == pytest.approx(0.32, abs=0.03)
    assert tells_apart(advantage, Rules())


def test_neither_does_it_among_look_alikes():
    truth, rival = (SimpleNamespace(score=_scored(more)) for more in (0.0, 1.5))
    assert not leaves_little_more(rival, truth, Rules(), at_noise=True)
    assert leaves_little_more(rival, truth, Rules(), at_noise=False)
    assert leaves_little_more(truth, truth, Rules(), at_noise=True)


def test_what_is_worse_over_all_outputs_has_no_advantage():
    assert not tells_apart(Comparison(-0.01, 1e-9, 5.0, largest=0.5), Rules())
    assert not tells_apart(Comparison(0.001, 0.2, 5.0, largest=0.5), Rules())
