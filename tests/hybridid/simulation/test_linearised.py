"""A model linearised along a record: its slopes and modes are those of the textbook's oscillator."""

from __future__ import annotations

from dataclasses import replace

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


def test_where_friction_holds_a_machine_its_smoothed_sign_makes_the_slopes():
    """At rest it seems to creep at k epsilon/f_c; at 40 times epsilon it swings at sqrt(k/m)."""
    model = compose(Duffing(), ["coulomb"])
    (port,) = model.equation_ports
    still = _resting()
    way = 40 * port.epsilon * np.maximum(still.time - still.time[STEPS // 2], 0.0)
    known = {"m": MASS, "d": DAMPING, "k": STIFFNESS, "oscillator.coulomb.f_c": 0.3}
    every = list(linearised(model, model.values(known), [replace(still, outputs=way[:, None])]))
    resting, moving = ([at for at in every if at.creeps is creeps] for creeps in (True, False))
    assert len(resting) > PROBES / 3
    assert len(moving) > PROBES / 3
    first, last = resting[0], moving[-1]
    assert np.abs(first.modes).min() == pytest.approx(STIFFNESS * port.epsilon / 0.3, rel=0.01)
    assert np.abs(last.modes).min() == pytest.approx(np.sqrt(STIFFNESS / MASS), rel=0.01)
