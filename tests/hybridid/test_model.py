"""Models nest, compose at any port, and solve for accelerations exactly."""

from __future__ import annotations

import pickle

import casadi as ca
import numpy as np
import pytest

from benchmarks.rebuilt.tanks import Tanks
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.effects.effect import Dimension, Effect, EffectParameter, EffectState
from hybridid.effects.library import EFFECTS
from hybridid.model import Model, Term, compose
from hybridid.plants.emps import EMPS
from hybridid.plants.plant import Motion, Plant

INERTIA = Effect(
    id="inertia",
    kind="effort",
    title="added inertia, written here",
    equation="F = m_a a",
    law=lambda at: at.p.m_a * at.acceleration,
    parameters=(EffectParameter("m_a", Dimension(effort=1, position=-1, time=2), "mass", 0.1, nests=True),),
    source="this test",
    pattern="none",
)
BENT = Effect(
    id="bent",
    kind="effort",
    title="an effort that is not linear in the acceleration",
    equation="F = c a^2",
    law=lambda at: at.p.c * at.acceleration**2,
    parameters=(EffectParameter("c", Dimension(effort=1), "", 0.1, nests=True),),
    source="this test",
    pattern="none",
)
GAIN = Effect(
    id="gain",
    kind="input",
    title="gain error",
    equation="u + g u",
    law=lambda at: at.p.g * at.signal,
    parameters=(EffectParameter("g", Dimension(), "", 0.1, nests=True),),
    source="this test",
    pattern="none",
)
LAG = Effect(
    id="lag",
    kind="output",
    title="first-order sensor, blended in",
    equation="y + b (z - y), z' = (y - z)/T",
    law=lambda at: at.p.b * (at.z.z - at.signal),
    parameters=(
        EffectParameter("b", Dimension(), "", 0.5, nests=True),
        EffectParameter("T", Dimension(time=1), "", 0.1),
    ),
    states=(EffectState("z", Dimension(effort=1), ""),),
    dynamics=lambda at: {"z": (at.signal - at.z.z) / at.p.T},
    source="this test",
    pattern="none",
)


class TwoMasses(Plant):
    """``m_1 a_1 = u - F_1 - F_12, m_2 a_2 = F_12 - F_2``, F_12 the effort at the joint."""

    name = "two_masses"
    meaning = source = "this test"
    states = tuple(
        State(name, unit) for name, unit in (("q1", "m"), ("v1", "m/s"), ("q2", "m"), ("v2", "m/s"))
    )
    inputs = (Signal("u", "N"),)
    outputs = (Signal("y", "m"),)
    parameters = (Parameter("m_1", "kg", 2.0), Parameter("m_2", "kg", 3.0))
    ports = (Port("motor", "effort", "N", 1.0, "m"), Port("joint", "effort", "N", 1.0, "m"))

    def motion(self, x, u, p):
        return {"motor": Motion(x.q1, x.v1), "joint": Motion(x.q1 - x.q2, x.v1 - x.v2)}

    def derivative(self, x, u, p, effort):
        return {
            "q1": x.v1,
            "v1": (u.u - effort["motor"] - effort["joint"]) / p.m_1,
            "q2": x.v2,
            "v2": effort["joint"] / p.m_2,
        }

    def output(self, x, u, p):
        return {"y": x.q2}


def rate(model: Model, x, u, **values) -> np.ndarray:
    return np.asarray(model.f(0.0, x, u, model.values(values))).ravel()


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.id)
def test_a_model_lies_inside_the_model_with_one_effect_more(effect, pressed, tank):
    if effect.into:
        base = compose(Tanks(), ["orifice_leak"])
    elif effect.kind == "flow":
        base = compose(tank, ["linear_leak" if effect.id == "orifice_leak" else "orifice_leak"])
    else:
        base = compose(pressed, ["viscous", "offset"] if effect.id == "coulomb" else ["coulomb"])
    n = len(base.states)
    more = base.plus(effect, "upper+lower" if effect.into else None)
    zero = {
        p.name: 0.0
        for p in more.parameters
        if p.name.split(".")[-1] in nesting(effect) and effect.id in p.name
    }
    generator = np.random.default_rng(1)
    for _ in range(5):
        x = generator.normal(scale=(0.1, 0.05))[:n]
        z = generator.normal(size=len(more.states) - n)
        u = generator.normal(scale=40)
        args = (0.3, np.append(x, z), u, more.values(zero))
        expected = np.asarray(base.f(0.3, x, u, base.values())).ravel()
        np.testing.assert_allclose(np.asarray(more.f(*args)).ravel()[:n], expected, rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(np.asarray(more.h(*args)), base.h(0.3, x, u, base.values()), atol=1e-15)


def nesting(effect: Effect) -> list[str]:
    return [p.name for p in effect.parameters if p.nests]


def test_a_law_over_an_input_has_the_kind_of_its_port(tank, pressed):
    for plant, entry, kind in (
        (tank, "cube_of_inflow@tank", "flow"),
        (pressed, "cube_of_force@carriage", "effort"),
    ):
        assert [term.effect.kind for term in compose(plant, [entry]).terms] == [kind]


def test_plus_then_without_is_the_same_model():
    base = compose(EMPS(), ["viscous"])
    more = base.plus(next(e for e in EFFECTS if e.id == "coulomb"))
    assert [t.name for t in more.terms] == ["carriage.viscous", "carriage.coulomb"]
    again = more.without("carriage.coulomb")
    assert again == base
    assert [t.name for t in base.terms] == ["carriage.viscous"], "the first model must not change"
    names = [p.name for p in more.parameters]
    assert names == ["M", "carriage.viscous.f_v", "carriage.coulomb.f_c", "carriage.epsilon"]


def test_friction_resists_what_moves():
    model = compose(EMPS(), ["viscous", "coulomb", "offset"])
    values = {
        "M": 2.0,
        "carriage.viscous.f_v": 3.0,
        "carriage.coulomb.f_c": 5.0,
        "carriage.offset.offset": 0.7,
        "carriage.epsilon": 0.1,
    }
    expected = (11.0 - 3.0 * 0.05 - 5.0 * np.tanh(0.5) - 0.7) / 2.0
    np.testing.assert_allclose(rate(model, [0.4, 0.05], 11.0, **values), [0.05, expected], rtol=1e-14)
    efforts = np.asarray(model.efforts(0.0, [0.4, 0.05], 11.0, model.values(values))).ravel()
    np.testing.assert_allclose(efforts, [0.15, 5.0 * np.tanh(0.5), 0.7], rtol=1e-14)
    np.testing.assert_allclose(model.motions(0.0, [0.4, 0.05], 11.0, model.values(values)), [[0.4, 0.05]])


def test_added_inertia_is_solved_exactly():
    model = compose(EMPS(), ["viscous", INERTIA])
    values = {"M": 90.0, "carriage.viscous.f_v": 200.0, "carriage.inertia.m_a": 35.0}
    found = rate(model, [0.1, 0.05], 40.0, **values)
    acceleration = (40.0 - 200.0 * 0.05) / (90.0 + 35.0)
    np.testing.assert_allclose(found, [0.05, acceleration], rtol=1e-14)
    efforts = np.asarray(model.efforts(0.0, [0.1, 0.05], 40.0, model.values(values))).ravel()
    np.testing.assert_allclose(efforts, [10.0, 35.0 * acceleration], rtol=1e-14)


def test_inertias_at_coupled_ports_are_solved_together():
    model = Model(TwoMasses(), (Term(INERTIA, "motor"), Term(INERTIA, "joint")))
    found = rate(model, [0, 0, 0, 0], 7.0, **{"motor.inertia.m_a": 0.5, "joint.inertia.m_a": 4.0})
    # (m_1 + 0.5) a_1 + 4 (a_1 - a_2) = u,  m_2 a_2 = 4 (a_1 - a_2)
    a = np.linalg.solve([[2.5 + 4.0, -4.0], [-4.0, 3.0 + 4.0]], [7.0, 0.0])
    np.testing.assert_allclose(found[[1, 3]], a, rtol=1e-13)


def test_acceleration_that_enters_nonlinearly_is_refused():
    with pytest.raises(ValueError, match=r"carriage.bent: .*linearly"):
        _ = compose(EMPS(), [BENT]).f


def test_an_effect_on_the_input_path_changes_the_input():
    model = compose(EMPS(), ["viscous", GAIN])
    plain = compose(EMPS(), ["viscous"])
    found = rate(model, [0.0, 0.02], 10.0, **{"force.gain.g": 0.25})
    np.testing.assert_allclose(found, rate(plain, [0.0, 0.02], 12.5), rtol=1e-14)


def test_effects_on_one_path_act_one_after_the_other():
    offset = Effect(
        "plus",
        "input",
        "",
        "",
        lambda at: at.p.c,
        "",
        "",
        (EffectParameter("c", Dimension(), "", nests=True),),
    )
    model = compose(EMPS(), [GAIN, offset])
    found = rate(model, [0.0, 0.0], 10.0, **{"M": 1.0, "force.gain.g": 1.0, "force.plus.c": 3.0})
    assert found[1] == pytest.approx(23.0)


def test_an_effect_on_the_output_path_has_states_of_its_own():
    model = compose(EMPS(), [LAG])
    assert [s.name for s in model.states] == ["q", "v", "position.lag.z"]
    values = model.values({"position.lag.b": 1.0, "position.lag.T": 0.2})
    y = model.h(0.0, [0.3, 0.0, 0.1], 0.0, values)
    assert float(y) == pytest.approx(0.1)
    assert float(model.f(0.0, [0.3, 0.0, 0.1], 0.0, values)[2]) == pytest.approx((0.3 - 0.1) / 0.2)


def test_adjustments_change_guesses_bounds_and_what_is_known():
    model = compose(
        EMPS(),
        ["viscous", "coulomb"],
        {
            "M": {"guess": 95.0},
            "carriage.viscous.f_v": {"lower": 100.0, "upper": 300.0},
            "carriage.coulomb.f_c": {"fixed": 20.4},
        },
    )
    by_name = {p.name: p for p in model.parameters}
    assert by_name["M"].guess == 95.0
    assert by_name["M"].lower == 1.0
    f_v, f_c = by_name["carriage.viscous.f_v"], by_name["carriage.coulomb.f_c"]
    assert f_v.lower < f_v.guess < f_v.upper
    assert (f_v.lower, f_v.upper) == (100.0, 300.0)
    assert (f_c.fixed, f_c.guess) == (True, 20.4)
    assert [p.name for p in model.free] == ["M", "carriage.viscous.f_v"]


def test_what_nobody_adjusts_stays_as_declared():
    class Declared(EMPS):
        parameters = (Parameter("M", "kg", guess=0.0, lower=0.0, upper=1.0, scale=0.25),)

    M = compose(Declared(), ["viscous"], {"carriage.viscous.f_v": {"guess": 2.0}}).parameters[0]
    assert (M.guess, M.lower, M.upper, M.scale) == (0.0, 0.0, 1.0, 0.25)


def test_a_small_guess_is_no_scale_of_what_is_nothing_by_default():
    """The records may determine an offset near nothing very well."""
    declared = {p.name: p.scale for p in compose(EMPS(), ["offset", "viscous"]).parameters}
    given = {"carriage.offset.offset": {"guess": -2e-5}, "carriage.viscous.f_v": {"guess": 100.0}}
    scale = {p.name: p.scale for p in compose(EMPS(), ["offset", "viscous"], given).parameters}
    assert scale["carriage.offset.offset"] == declared["carriage.offset.offset"]
    assert scale["carriage.viscous.f_v"] == 100.0


def test_nothing_between_equal_bounds_is_known():
    M = compose(EMPS(), [], {"M": {"lower": 70.0, "upper": 70.0}}).parameters[0]
    assert (M.fixed, M.guess) == (True, 70.0)


@pytest.mark.parametrize(
    ("adjustments", "words"),
    [
        ({"carriage.viscous.f_w": {"guess": 1.0}}, "did you mean 'carriage.viscous.f_v'"),
        ({"M": {"guss": 1.0}}, "did you mean 'guess'"),
        ({"M": {"lower": 10.0, "upper": 5.0}}, "crossed"),
        ({"M": {"guess": 2000.0}}, "outside"),
        ({"carriage.epsilon": {"fixed": 0.0}}, "carriage.epsilon is 0 m/s"),
    ],
)
def test_wrong_adjustments_say_what_is_wrong_in_one_line(adjustments, words):
    with pytest.raises(ValueError, match=words) as caught:
        compose(EMPS(), ["viscous"], adjustments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("effects", "words"),
    [
        (["viscos"], "did you mean 'viscous'"),
        (["viscous@cariage"], "did you mean 'carriage'"),
        (["viscous", "viscous"], "stands twice"),
        (["viscous@"], "names no port; ports: "),
        (["viscous@force"], "acts at effort ports"),
        (["nowhere.to_be:FOUND"], "No module named 'nowhere'"),
        (["hybridid.plants.emps:EMPS"], "not a hybridid.effects.effect.Effect"),
    ],
)
def test_wrong_effects_say_what_is_wrong_in_one_line(effects, words):
    with pytest.raises(ValueError, match=words) as caught:
        compose(EMPS(), effects)
    assert "\n" not in str(caught.value)


def test_misspelt_terms_ports_and_values_get_the_nearest_name():
    model = compose(EMPS(), ["viscous"])
    with pytest.raises(ValueError, match=r"did you mean 'carriage\.viscous'"):
        model.without("carriage.viscos")
    with pytest.raises(ValueError, match="did you mean 'carriage'"):
        model.plus(INERTIA, "carrige")
    with pytest.raises(ValueError, match=r"did you mean 'carriage\.viscous\.f_v'"):
        model.values({"carriage.viscous.fv": 1.0})


def test_a_plant_without_the_kind_of_port_says_so():
    with pytest.raises(ValueError, match="two_masses has no output port for effect lag"):
        Model(TwoMasses()).plus(LAG)


def test_models_travel_to_other_processes():
    model = compose(EMPS(), ["viscous", "coulomb"], {"M": {"fixed": 50.0}})
    _ = model.f  # built functions stay behind
    again = pickle.loads(pickle.dumps(model))
    np.testing.assert_array_equal(rate(again, [0.1, 0.2], 3.0), rate(model, [0.1, 0.2], 3.0))


def test_time_reaches_an_effect():
    shake = Effect(
        "shake",
        "effort",
        "",
        "",
        lambda at: at.p.A * ca.sin(at.time),
        "",
        "",
        (EffectParameter("A", Dimension(1), "", nests=True),),
    )
    model = compose(EMPS(), [shake], {"M": {"fixed": 2.0}})
    p = model.values({"carriage.shake.A": 3.0})
    assert float(model.f(0.5, [0, 0], 0.0, p)[1]) == pytest.approx(-3.0 * np.sin(0.5) / 2.0)


def test_an_effect_needs_a_parameter_that_removes_it():
    with pytest.raises(ValueError, match="no parameter nests"):
        Effect("x", "effort", "", "", lambda at: 1.0, "", "")
    with pytest.raises(ValueError, match="go together"):
        Effect("x", "effort", "", "", lambda at: 1.0, "", "", GAIN.parameters, LAG.states)
