"""Every effect at the EMPS: planted in three simulated seconds, the estimator finds its way back to it.

Everything else is known here, so that nothing can take the effect's place; which effects hide
behind one another is the business of the trace. Flows are planted in a tank, in ``test_library_flows``.
"""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.library import EFFECTS
from hybridid.estimators import FitSettings, fit
from hybridid.model import Model, Term, compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Channel, Record
from hybridid.simulation import simulate

DT, N = 2e-3, 1500
TIME = DT * np.arange(N)
PORT_OF = {"effort": "carriage", "input": "force", "output": "position"}
KNOWN = {"M": 90.0, "carriage.viscous.f_v": 200.0, "carriage.coulomb.f_c": 20.0, "carriage.epsilon": 3e-3}
PLANTED = {
    "offset": {"offset": 3.0},
    "asymmetric_viscous": {"df_v": 40.0},
    "asymmetric_coulomb": {"df_c": 4.0},
    "preloaded_spring": {"F_0": 8.0},
    "cubic_stiffness": {"k_3": 2e5, "q_0": 0.01},
    "friction_drift": {"r_c": 2.0, "r_v": 10.0},
    "periodic_disturbance": {"A_s": 4.0, "A_c": 3.0},
    "end_stop": {"d": 0.005},
    "wheel_lift_off": {"d": 0.01},
    "input_saturation": {"inverse_limit": 1 / 60},
    "blow_off_valve": {"dc": 100.0, "v_b": 0.03},
    "centrifugal_brake": {"k": 2000.0, "v_0": 0.03},
    "varying_inertia": {"m_1": 150.0, "m_2": 3000.0},
    "detent": {"F_d": 5.0, "q_0": 0.01, "w": 0.005},
    "friction_beyond_gap": {"f_c": 5.0, "g": 0.01},
    "varying_force_factor": {"b_1": 2.0, "b_2": 300.0},
    "torque_ripple": {"b_s": 0.1, "b_c": 0.05, "pitch": 0.02},
    "back_emf_limit": {"inverse_limit": 1 / 60, "v_0": 0.5},
    "input_nonlinearity": {"c": -2e-3},
    "input_rate_limit": {"inverse_rate": 1 / 1500},
    "sensor_nonlinearity": {"c_2": 0.5, "c_3": 5.0},
    "sensor_periodic_error": {"period": 0.01},
    "two_sided_load_friction": {"mu_d": 0.03, "mu_l": 0.2},
}
"""What to plant where the guess is nothing or out of this motion's reach, in SI units."""
HIDDEN = {
    "gravity": "in metres sin and cos are a line and a constant",
    "sensor_offset": "a position that is integrated has no zero of its own",
}


def force() -> np.ndarray:
    """From rest, strokes to and fro of some centimetres with a tremor, in N."""
    t = TIME - 0.1
    stroke = 45 * np.sign(np.cos(2 * np.pi * t / 1.5)) * (np.abs(np.cos(2 * np.pi * t / 1.5)) > 0.3)
    return np.where(t > 0, stroke + 12 * np.sin(2 * np.pi * 3 * t) + 6 * np.sin(2 * np.pi * 11 * t), 0.0)


def record_of(position: np.ndarray) -> Record:
    channels = (Channel("force", "N"),), (Channel("position", "m"),)
    return Record("planted", TIME, force()[:, None], position[:, None], *channels, simulated=True)


def position_of(model: Model, values: dict[str, float]) -> np.ndarray:
    """Position (n,) that the model makes of the force, from rest."""
    some_motion = record_of(np.sin(TIME))
    return simulate(model, values, some_motion, np.zeros(len(model.states)), substeps=4).outputs[:, 0]


def machine_with(effect, plant) -> tuple[Model, dict[str, float]]:
    """The known EMPS with one unknown effect, and its parameters by qualified name."""
    others = [name for name in ("viscous", "coulomb") if name != effect.id]
    port = PORT_OF[effect.kind]
    name = Term(effect, port).name
    fixed = {p: {"fixed": value} for p, value in KNOWN.items() if not p.startswith(f"{name}.")}
    model = compose(plant, [*others, f"{effect.id}@{port}"], fixed)
    guesses = {p.name: p.at(model.plant.port(port)).guess for p in effect.parameters}
    return model, {f"{name}.{k}": v for k, v in (guesses | PLANTED.get(effect.id, {})).items()}


FITTED = [e for e in EFFECTS if e.id not in HIDDEN and e.kind != "flow"]


@pytest.mark.parametrize("effect", FITTED, ids=lambda effect: effect.id)
def test_a_planted_effect_is_fitted_back(effect, pressed):
    model, truth = machine_with(effect, pressed)
    record = record_of(position_of(model, truth))
    amplitudes = {
        name for name in truth if name.rsplit(".", 1)[1] in {p.name for p in effect.parameters if p.nests}
    }
    # its limit out of reach, a saturation shows no slope
    limited = {"inverse_limit", "inverse_rate"} & {p.name for p in effect.parameters}
    share = 0.5 if limited else 0.0
    start = {name: value * (share if name in amplitudes else 1.0) for name, value in truth.items()}
    before = np.std(position_of(model, start) - record.output("position"))
    assert before > 1e-6, "the effect must change the motion"

    # a sensor that errs says a wrong initial state
    known = "estimated" if effect.id == "sensor_periodic_error" else "measured"
    settings = FitSettings(
        start="guess", continuation=(1.0,), max_iterations=15, initial_state=known, substeps=4
    )
    found = fit(model, [record], settings, start_values=start)

    assert np.isfinite(list(found.values.values())).all()
    after = np.std(position_of(model, found.values) - record.output("position"))
    assert after < 0.02 * before
    for name in amplitudes:
        assert found.values[name] == pytest.approx(truth[name], rel=0.03)


@pytest.mark.parametrize(
    ("planted", "found"), [(0.5, (0.33, 0.5)), (0.01, (0.0, 0.033)), (0.001, (0.0, 0.004))]
)
def test_a_saturation_is_as_sharp_as_the_records_show(planted, found):
    """Iron bends early, software clips."""
    model = compose(EMPS(), ["viscous", "coulomb", "input_saturation"])
    truth = {**KNOWN, "force.input_saturation.inverse_limit": 1 / 50, "force.input_saturation.bend": planted}
    record = record_of(position_of(model, truth))
    known = {name: {"fixed": value} for name, value in KNOWN.items() if name != "M"}
    free = compose(EMPS(), ["viscous", "coulomb", "input_saturation"], known)
    values = fit(free, [record], FitSettings(starts=4)).values
    assert found[0] <= values["force.input_saturation.bend"] <= found[1]
    assert values["force.input_saturation.inverse_limit"] == pytest.approx(1 / 50, rel=0.02)
    assert values["M"] == pytest.approx(KNOWN["M"], rel=0.01)
