"""The library as a whole: complete, documented, nested, differentiable, and where it may be used."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from benchmarks.rebuilt.tanks import Tanks
from hybridid.declarations import Port
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.model import Model, Term, compose
from hybridid.plants.emps import EMPS

PROMISED = [
    "offset",
    "viscous",
    "coulomb",
    "stribeck",
    "asymmetric_viscous",
    "asymmetric_coulomb",
    "quadratic_drag",
    "dahl",
    "lugre",
    "position_friction",
    "cyclic_friction",
    "friction_beyond_gap",
    "cogging",
    "linear_stiffness",
    "preloaded_spring",
    "cubic_stiffness",
    "backlash",
    "end_stop",
    "bouc_wen",
    "hardening_hysteresis",
    "maxwell",
    *("second_maxwell", "third_maxwell"),
    "gravity",
    "added_inertia",
    "friction_drift",
    "periodic_disturbance",
    "flexible_mode",
    "asymmetric_damper",
    "wheel_lift_off",
    "load_friction",
    "load_stribeck",
    "two_sided_load_friction",
    "input_scaled_friction",
    "friction_behind_play",
    "warming_friction",
    *("eddy_brake", "position_damping", "blow_off_valve", "centrifugal_brake"),
    "varying_inertia",
    "cyclic_inertia",
    "overflow",
    "overflow_into",
    "orifice_leak",
    "linear_leak",
    "steady_leak",
    "periodic_flow",
    "detent",
    "back_emf_limit",
    "varying_force_factor",
    "torque_ripple",
    "input_gain",
    "input_delay",
    "input_lag",
    "input_saturation",
    "input_dead_zone",
    *("sensor_lag", "input_record_lag"),
    "sensor_scale",
    "sensor_offset",
    "sensor_nonlinearity",
    "sensor_periodic_error",
]
IDS = [effect.id for effect in EFFECTS]
LEAST_LETTERS = {"title": 6, "equation": 6, "source": 15, "pattern": 40, "separating_experiment": 40}
PORT_OF = {"effort": "carriage", "flow": "tank", "input": "force", "output": "position"}
each_effect = pytest.mark.parametrize("effect", EFFECTS, ids=IDS)


@pytest.fixture
def plant(effect, pressed, tank):
    """Where the effect is possible: on the carriage, on the tank, or from one tank into another."""
    if effect.into:
        return Tanks()
    return tank if effect.kind == "flow" else pressed


def with_effect(effect, plant) -> Model:
    """The bare plant with one effect, wherever its kind fits."""
    port = "upper+lower" if effect.into else PORT_OF[effect.kind]
    return Model(plant, (Term(effect, port),))


def random_points(model: Model, rng, count: int = 20):
    """Times, states, inputs and parameters about where the machine lives; every fifth state at rest."""
    scale = np.array([s.scale for s in model.states])
    for k in range(count):
        x = rng.normal(size=len(scale)) * scale * (k % 5 > 0)
        p = np.array([q.guess if q.fixed else q.guess * rng.uniform(0.5, 1.5) for q in model.parameters])
        yield rng.uniform(0, 20), x, rng.normal(size=1) * 30.0, p


def test_every_promised_effect_is_there_once():
    assert len(IDS) == len(set(IDS))
    assert set(PROMISED) <= set(IDS)


@each_effect
def test_every_effect_is_documented(effect):
    for name, least in LEAST_LETTERS.items():
        assert len(getattr(effect, name)) >= least, name
    assert all(p.meaning for p in effect.parameters)
    assert all(s.meaning for s in effect.states)
    assert any(year in effect.source for year in map(str, range(1900, 2030))) or "thesis" in effect.source
    assert effect.look_alikes
    assert effect.id not in effect.look_alikes
    assert set(effect.look_alikes) <= set(IDS)


@each_effect
def test_every_parameter_stands_in_the_equation(effect):
    """Under its own name, or the Greek letter that its meaning or the name itself stands for."""
    letters = {
        "mu": "μ",
        "mu_s": "μ_s",
        "mu_d": "μ_d",
        "delta": "δ",
        "mu_l": "μ_l",
        "tau": "τ",
        "tau_b": "τ_b",
        "zeta": "ζ",
        "sigma": "σ",
        "f_v": "f_v",
    }
    realisation = {"width", "window", "inverse_limit", "inverse_rate", "size"}
    for p in effect.parameters:
        if p.name not in realisation:
            assert letters.get(p.name, p.name) in effect.equation, p.name


@each_effect
def test_zero_amplitude_removes_it_exactly(effect, plant):
    rng = np.random.default_rng(1)
    bare, model = Model(plant), with_effect(effect, plant)
    n, own = len(plant.states), len(plant.parameters)
    nests = [f"{model.terms[0].name}.{p.name}" for p in effect.parameters if p.nests]
    order = [p.name for p in model.parameters]
    for t, x, u, p in random_points(model, rng):
        p[[order.index(name) for name in nests]] = 0.0
        assert np.array_equal(np.asarray(model.f(t, x, u, p))[:n], np.asarray(bare.f(t, x[:n], u, p[:own])))
        assert np.array_equal(np.asarray(model.h(t, x, u, p)), np.asarray(bare.h(t, x[:n], u, p[:own])))


@each_effect
def test_an_amplitude_changes_something(effect, plant):
    rng = np.random.default_rng(2)
    bare, model = Model(plant), with_effect(effect, plant)
    n, own = len(plant.states), len(plant.parameters)
    order = [p.name for p in model.parameters]
    changed = 0.0
    for t, x, u, p in random_points(model, rng):
        for q in effect.parameters:
            k = order.index(f"{model.terms[0].name}.{q.name}")
            p[k] = p[k] or q.scale_at(model.plant.port(model.terms[0].port))
        x = x + np.array([s.scale for s in model.states])
        gap_f = np.asarray(model.f(t, x, u, p))[:n] - np.asarray(bare.f(t, x[:n], u, p[:own]))
        gap_h = np.asarray(model.h(t, x, u, p)) - np.asarray(bare.h(t, x[:n], u, p[:own]))
        changed = max(changed, np.abs(gap_f).max(), np.abs(gap_h).max())
    assert changed > 1e-6


@each_effect
def test_derivatives_are_finite_everywhere(effect, plant):
    """By states, input and parameters, at rest, in motion, and with the amplitude at zero."""
    rng = np.random.default_rng(3)
    model = with_effect(effect, plant)
    symbols = [
        ca.SX.sym("t"),
        *(
            ca.SX.sym(n, len(part))
            for n, part in zip("xup", (model.states, model.inputs, model.parameters), strict=True)
        ),
    ]
    out = ca.vertcat(model.f(*symbols), model.h(*symbols))
    slope = ca.Function("slope", symbols, [out, ca.jacobian(out, ca.vertcat(*symbols[1:]))])
    nests = [
        k
        for k, p in enumerate(model.parameters)
        if p.name.rsplit(".", 1)[-1] in {q.name for q in effect.parameters if q.nests}
    ]
    for k, (t, x, u, p) in enumerate(random_points(model, rng, 40)):
        if k % 3 == 0:
            p[nests] = 0.0
        if k % 4 == 0:
            u = 0 * u
        for value in slope(t, x, u, p):
            assert np.isfinite(np.asarray(value)).all()


BLIND_AT_ZERO = {"input_saturation", "back_emf_limit"}
"""Their limit at infinity is out of any input's reach: a fit has to start from a limit."""


@each_effect
def test_a_fit_can_leave_zero_amplitude(bench, effect):
    """The slope by the amplitude at zero is not zero, so that a fit may start from the poorer model."""
    at_port = bench(effect)
    zero = dict.fromkeys(at_port.amplitudes, 0.0)
    seen = {"time": 0.317, "position": 0.17, "velocity": -0.05, "acceleration": 1.0, "signal": 4.0}
    seen |= {"drive": 3.0, "load": -1.0, "level": 0.8, "rate": 0.7}
    if effect.id == "wheel_lift_off":
        seen["position"] = -0.17
    if effect.id == "detent":
        seen["position"] = 0.017
    if effect.id == "friction_beyond_gap":
        seen["position"] = 0.5
    if effect.id in ("blow_off_valve", "centrifugal_brake"):
        seen["velocity"] = -2.0
    slopes = at_port.slopes(z=[0.3] * len(effect.states), p=zero, **seen)[0]
    offset = at_port.n_seen + len(effect.states)
    for k, p in enumerate(effect.parameters):
        if p.nests:
            assert (abs(slopes[offset + k]) > 1e-6) == (effect.id not in BLIND_AT_ZERO)


@each_effect
def test_guesses_and_bounds_are_sensible_at_every_port(effect):
    hinge = Port("hinge", "effort", "N·m", 2.0, "rad", 1.0, velocity_scale=3.0)
    level = Port("level", "flow", "m³/s", 1e-3, "m", 0.3, velocity_scale=0.05)
    for port in (*EMPS().ports, hinge, level):
        if port.kind != effect.kind:
            continue
        for p in effect.parameters:
            declared = p.at(port)
            assert declared.lower <= declared.guess <= declared.upper
            assert declared.scale > 0
            assert all(declared.lower <= start <= declared.upper for start in p.starts_at(port))
            assert not (p.fixed and p.nests)
            if p.nests:
                assert declared.lower <= 0.0 <= declared.upper
            if p.sought not in ("", "load", "limit"):
                assert not p.nests


def test_shape_parameters_that_many_valleys_await_have_several_starts():
    wanted = {
        "stribeck": "v_s",
        "lugre": "v_s",
        "dahl": "s",
        "bouc_wen": "s",
        "hardening_hysteresis": "s",
        "cogging": "pitch",
        "backlash": "g",
        "free_play": "g",
        **dict.fromkeys(("maxwell", "second_maxwell", "third_maxwell"), "tau"),
        "flexible_mode": "frequency",
        "periodic_disturbance": "frequency",
        "periodic_flow": "frequency",
        "end_stop": "d",
        "wheel_lift_off": "d",
        "asymmetric_damper": "v_k",
        "load_stribeck": "v_s",
        "eddy_brake": "v_c",
        "blow_off_valve": "v_b",
        "centrifugal_brake": "v_0",
        "warming_friction": "tau",
        "friction_behind_play": "g",
    }
    for id_, name in wanted.items():
        p = next(p for p in effect_named(id_).parameters if p.name == name)
        assert p.starts, id_
        assert p.lower > 0 or id_ == "end_stop", "a shape that is singular at zero is bounded away from it"


def test_effects_are_searched_where_they_make_sense():
    carriage, force, position = EMPS().ports
    tyre = Port("front_tyre", "effort", "N", 5000.0, "m", 0.02, velocity_scale=0.5)
    strut = Port("rear_suspension", "effort", "N", 2000.0, "m", 0.05, velocity_scale=0.5)
    hinge = Port("hinge", "effort", "N·m", 1.0, "rad", 1.0, velocity_scale=1.0)
    tank = Port("upper", "flow", "V/s", 0.1, "V", 5.0, velocity_scale=0.05)
    ports = (carriage, force, position, tyre, strut, hinge, tank)
    sensible = {
        "gravity": (hinge,),
        "wheel_lift_off": (tyre,),
        "asymmetric_damper": (strut,),
        "viscous": (carriage, tyre, strut, hinge),
        "load_friction": (carriage,),
        "two_sided_load_friction": (),
        "input_scaled_friction": (),
        "blow_off_valve": (strut,),
        "varying_inertia": (carriage, tyre, strut),
        "cyclic_inertia": (hinge,),
        "overflow": (tank,),
        "periodic_flow": (tank,),
        "detent": (carriage, tyre, strut, hinge),
        "back_emf_limit": (carriage,),
        "input_delay": (force,),
        **dict.fromkeys(("sensor_lag", "input_record_lag"), (position,)),
    }
    for id_, where in sensible.items():
        found = [port for port in ports if effect_named(id_).admissible_at(port)]
        assert found == list(where), id_


def test_absolute_numbers_do_not_follow_the_port():
    slow = Port("valve", "effort", "N", 1.0, "m", 1.0, velocity_scale=1e-3)
    frequency = next(p for p in effect_named("periodic_disturbance").parameters if p.absolute)
    assert frequency.at(slow).guess == frequency.guess
    assert frequency.starts_at(slow) == frequency.starts
    mode = next(p for p in effect_named("flexible_mode").parameters if p.name == "frequency")
    assert mode.at(slow).guess == pytest.approx(mode.guess / 1000)
    assert mode.starts_at(slow) == pytest.approx([start / 1000 for start in mode.starts])


def test_fixed_constants_are_known_and_not_estimated():
    model = compose(EMPS(), ["input_delay", "backlash"])
    free = {p.name for p in model.free}
    assert "force.input_delay.delay" in free
    assert "force.input_delay.window" not in free
    assert "carriage.backlash.width" not in free
    wider = compose(EMPS(), ["input_delay"], {"force.input_delay.window": {"fixed": 0.05}})
    assert wider.values()[[p.name for p in wider.parameters].index("force.input_delay.window")] == 0.05


def test_the_drives_path_is_at_rest_before_the_record_and_no_lag_has_free_initial_values():
    states = {s.name: s for s in compose(EMPS(), ["sensor_lag", "input_lag", "input_delay"]).states}
    assert {name: (s.begins_as, s.begins_by) for name, s in states.items() if s.begins_as} == {
        "force.input_lag.z": ("force", "force.input_lag.settled"),
        "force.input_delay.zeta_0": ("force", "force.input_delay.settled"),
    }
    assert all(s.observed_by is None for name, s in states.items() if "." in name)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("added_inertia.m_a", "kg"),
        ("flexible_mode.frequency", "Hz"),
        ("cubic_stiffness.k_3", "N/m³"),
        ("lugre.tau_b", "s"),
        ("dahl.s", "m"),
        ("friction_drift.r_v", "N/m"),
    ],
)
def test_units_read_as_an_engineer_writes_them(name, unit):
    id_, _, parameter = name.partition(".")
    model = compose(EMPS(), [id_])
    assert {p.name: p.unit for p in model.parameters}[f"carriage.{id_}.{parameter}"] == unit
