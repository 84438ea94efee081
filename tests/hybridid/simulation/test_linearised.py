"""A model linearised along a record: its slopes and modes are those of the textbook's oscillator."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.model import compose
from hybridid.plants.duffing import Duffing
from hybridid.records.record import Channel, Record
from hybridid.simulation.linearised import PROBES, linearised

MASS, DAMPING, STIFFNESS = 5e-6, 2e-4, 1.0
STEPS, DT = 400, 1e-3
MODEL = compose(Duffing())


def _resting() -> Record:
    zero = np.zeros((STEPS, 1))
    return Record(
        "rest",
        DT * np.arange(STEPS),
        zero,
        zero,
        (Channel("V1", "V"),),
        (Channel("V2", "V"),),
        simulated=True,
    )


def _values(mass: float = MASS):
    return MODEL.values({"m": mass, "d": DAMPING, "k": STIFFNESS})


def test_the_modes_are_the_roots_of_the_characteristic_equation():
    every = list(linearised(MODEL, _values(), [_resting()]))
    assert len(every) == PROBES
    expected = np.sort_complex(np.roots([MASS, DAMPING, STIFFNESS]))
    for at in every:
        np.testing.assert_allclose(np.sort_complex(at.modes), expected, rtol=1e-9)
        assert at.seconds == pytest.approx((STEPS - 1) * DT)


def test_slopes_are_by_scaled_states():
    at = next(linearised(MODEL, _values(), [_resting()]))
    displacement, velocity = (state.scale for state in MODEL.states)
    assert at.motion[0, 1] == pytest.approx(velocity / displacement)
    np.testing.assert_allclose(at.outputs, [[displacement, 0.0]])


def test_slopes_that_are_no_numbers_have_no_modes():
    at = next(linearised(MODEL, _values(mass=np.nan), [_resting()]))
    assert not at.finite
    assert at.modes.size == 0
