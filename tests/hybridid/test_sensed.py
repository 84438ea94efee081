"""Outputs that efforts are part of, and motion that a rig prescribes."""

from __future__ import annotations

import pytest

from hybridid.blame import OwnCodeError
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from pipelines.new.templates.test_rig import Specimen

Q, V, A = 0.004, 0.2, -7.0


def force(model, **values):
    """The load cell's reading at one motion."""
    p = model.values(values)
    return float(model.h(0.0, [Q], [V, A], p)[1])


def test_a_load_cell_reads_inertia_spring_and_effects():
    model = compose(Specimen(), ["viscous"])
    assert force(model, M=2.0, K=500.0, **{"specimen.viscous.f_v": 30.0}) == pytest.approx(
        2 * A + 500 * Q + 30 * V
    )


def test_an_effect_sees_the_acceleration_that_the_rig_prescribes():
    model = compose(Specimen(), ["added_inertia"])
    (name,) = [p.name for p in model.parameters if p.name.startswith("specimen.added_inertia")]
    assert force(model, M=2.0, K=0.0, **{name: 0.5}) == pytest.approx(2.5 * A)


class Accelerometer(EMPS):
    """The carriage of EMPS with a second sensor, whose reading holds the friction."""

    outputs = (*EMPS.outputs, type(EMPS.outputs[0])("acceleration", "m/s²", "accelerometer"))

    def sensed(self, x, u, p, effort):
        return {"acceleration": (u.force - effort["carriage"]) / p.M}


def test_an_accelerometer_reads_what_the_state_does():
    model = compose(Accelerometer(), ["viscous", "coulomb", "added_inertia"])
    x, u, p = [0.05, 0.1], [40.0], model.values()
    assert float(model.h(0.0, x, u, p)[1]) == pytest.approx(float(model.f(0.0, x, u, p)[1]), rel=1e-12)
    assert float(model.h(0.0, x, u, p)[0]) == 0.05


def test_an_output_that_nobody_declared_is_refused():
    class Wrong(EMPS):
        def sensed(self, x, u, p, effort):
            return {"pressure": u.force}

    with pytest.raises(OwnCodeError, match="pressure"):
        compose(Wrong(), ["viscous"]).h(0.0, [0.0, 0.0], [0.0], [1.0])
