"""Flows that leave a tank: Francis' and Torricelli's laws, and found again on a level that overflows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.declarations import Port
from hybridid.effects.dimension import DAMPING, EFFORT, INERTIA
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.simulation import simulate
from hybridid.trace.candidates import admissible


def test_an_overflow_is_a_weirs(bench):
    """Nothing below the edge, 1.84 b H^1.5 above it, for a weir of b = 0.2 m."""
    h = 0.1
    weir = bench("overflow", k=1.84 * 0.2 * h**0.5, limit=0.3, h=h, width=1e-6)
    for level in (0.31, 0.35, 0.6):
        assert weir.law(position=level) == pytest.approx(1.84 * 0.2 * (level - 0.3) ** 1.5, rel=1e-3)
    assert weir.law(position=0.29) == pytest.approx(0.0, abs=1e-12)


def test_an_orifice_is_torricellis_both_ways(bench):
    hole = bench("orifice_leak", c=3.0, h=0.25, width=1e-6)
    for level in (0.01, 0.25, 1.0):
        assert hole.law(position=level) == pytest.approx(3.0 * np.sqrt(level / 0.25), rel=1e-6)
        assert hole.law(position=-level) == -hole.law(position=level)


def test_a_linear_leak_doubles_with_the_level_and_a_steady_one_does_not_care(bench):
    linear, steady = bench("linear_leak", k=2e-3), bench("steady_leak", flow=5e-4)
    for level in (-0.1, 0.0, 0.2, 0.7):
        assert linear.law(position=level) == pytest.approx(2e-3 * level)
        assert steady.law(position=level, velocity=0.3) == 5e-4


def test_a_periodic_flow_is_the_periodic_disturbance_of_a_level(bench):
    """One law; its frequency goes with the level's own time, where a machine's is in Hz."""
    flow, effort = (
        bench(name, frequency=0.02, A_s=3e-4, A_c=1e-4) for name in ("periodic_flow", "periodic_disturbance")
    )
    for time in (0.0, 7.0, 31.0):
        assert flow.law(time=time) == effort.law(time=time) != 0.0
    slow, fast = (Port("tank", "flow", "m³/s", 1.0, "m", 1.0, velocity_scale=v) for v in (1e-3, 1.0))
    frequency = effect_named("periodic_flow").parameters[-1]
    assert frequency.at(fast).guess == pytest.approx(1000 * frequency.at(slow).guess)


def test_a_side_capacity_takes_what_its_level_gains(bench):
    """A step of the level by 0.3 m: τ later the second one has 63 % of it, and the flow has filled k τ times
    that."""
    k, tau, rise = 2e-3, 50.0, 0.01
    side = bench("side_capacity", k=k, tau=tau)
    time = np.linspace(0.0, rise + tau, 20001)
    flow, states = side.run(lambda t: {"rate": 0.3 / rise if t < rise else 0.0}, time)
    behind = states[:, 0]
    assert behind[-1] == pytest.approx(0.3 * np.exp(-1), rel=1e-3)
    assert np.trapezoid(flow, time) == pytest.approx(k * tau * (0.3 - behind[-1]), rel=1e-3)


def test_the_rate_of_a_level_counts_every_flow(tank):
    """Beside a leak the second capacity sees the level as it moves, not as the plant alone would move it."""
    model = compose(tank, ["side_capacity", "linear_leak"])
    values = {"tank.linear_leak.k": 2e-3, "tank.side_capacity.k": 3e-3, "tank.side_capacity.tau": 40.0}
    names = [s.name for s in model.states]
    x = np.array([0.02 if name.endswith(".d") else 0.4 for name in names])
    rates = np.asarray(model.f(0.0, x, np.zeros(model.f.size1_in(2)), model.values(values))).ravel()
    of = dict(zip(names, rates, strict=True))
    level = next(rate for name, rate in of.items() if not name.endswith(".d"))
    assert of["tank.side_capacity.d"] == pytest.approx(level - 0.02 / 40.0, rel=1e-12)


PLANTED = {
    "steady_leak": {"flow": 3e-4},
    "linear_leak": {"k": 1e-3},
    "orifice_leak": {"c": 6e-4, "h": 1.0},
    "overflow": {"k": 0.02, "limit": 0.4, "h": 1.0},
    "periodic_flow": {"A_s": 1e-4, "A_c": 5e-5, "frequency": 0.02},
    "side_capacity": {"k": 2e-3, "tau": 60.0},
}


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_flow_is_fitted_back(tank, leaking, name):
    """Every flow of the library, from nothing of it; shapes start near by."""
    truth = {f"tank.{name}.{p}": value for p, value in PLANTED[name].items()}
    known = {full: {"fixed": value} for full, value in truth.items() if full.endswith(".h")}
    model = compose(tank, [name], known)
    record = leaking().record()
    rest = np.zeros(len(model.states) - 1)
    planted = simulate(model, truth, record, np.array([0.35, *rest]), substeps=4).outputs
    record = replace(record, outputs=planted)
    amplitudes = {f"tank.{name}.{p.name}" for p in effect_named(name).parameters if p.nests}
    start = {full: 0.0 if full in amplitudes else 0.95 * value for full, value in truth.items()}
    settings = FitSettings(start="guess", initial_state="measured", substeps=4)
    found = fit(
        model, [record], settings, start_values={**start, **{k: v["fixed"] for k, v in known.items()}}
    )
    for full in amplitudes:
        assert found.values[full] == pytest.approx(truth[full], rel=0.02), full


def test_a_weir_and_a_hole_are_found_again(tank, leaking):
    record = leaking(weir=0.04).record()
    assert record.outputs.max() > 0.44
    assert record.outputs.min() < 0.35
    known = {"tank.overflow.h": {"fixed": 1.0}, "tank.orifice_leak.h": {"fixed": 1.0}}
    model = compose(tank, ["overflow", "orifice_leak"], known)
    settings = FitSettings(start="guess", continuation=(1.0,), initial_state="measured", substeps=4)
    start = {"tank.overflow.k": 0.0, "tank.overflow.limit": 0.3, "tank.orifice_leak.c": 0.0}
    found = fit(model, [record], settings, start_values=start).values
    assert found["tank.overflow.k"] == pytest.approx(0.04, rel=0.02)
    assert found["tank.overflow.limit"] == pytest.approx(0.4, abs=2e-3)
    assert found["tank.orifice_leak.c"] == pytest.approx(6e-4, rel=0.01)


def test_flows_are_tried_at_levels_only_and_nothing_else_of_the_equations_is(tank):
    """No friction, spring or inertia at a level, no flow at a carriage."""
    flows = {"steady_leak", "linear_leak", "orifice_leak", "periodic_flow", "side_capacity"}
    flows |= {"overflow", "overflow_into"}
    heats = {"natural_convection", "thermal_radiation"}
    level, (carriage, *_) = replace(tank.port("tank"), drive=""), EMPS().ports
    assert {effect.id for effect in EFFECTS if effect.admissible_at(level)} == flows
    supplied = {effect.id for effect in EFFECTS if effect.admissible_at(replace(level, drive="pump"))}
    assert supplied - flows == {"falling_supply"}
    assert not {effect.id for effect in EFFECTS if effect.admissible_at(carriage)} & (flows | heats)
    for unit in ("°C", "K"):
        heat = replace(level, position_unit=unit)
        left = {effect.id for effect in EFFECTS if effect.admissible_at(heat)}
        assert flows - left == {"overflow", "overflow_into", "orifice_leak"}
        assert left - flows == heats
    tried = {one.effect.kind for one in admissible(compose(tank), EFFECTS) if one.port == "tank"}
    assert tried == {"flow"}


def test_flows_look_like_flows_and_signals_only():
    kinds = {effect.id: effect.kind for effect in EFFECTS}
    for effect in EFFECTS:
        if effect.in_equations:
            others = {kinds[name] for name in effect.look_alikes}
            assert others <= {effect.kind, "input", "output"}, effect.id


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ("viscous", "plant tank has no effort port for effect viscous"),
        ("viscous@tank", "effect viscous acts at effort ports; tank is of kind flow"),
        ("end_stop@tank", "effect end_stop acts at effort ports; tank is of kind flow"),
    ],
)
def test_naming_a_mechanical_effect_at_a_level_is_refused(tank, wanted, said):
    with pytest.raises(ValueError, match=f"^{said}$"):
        compose(tank, [wanted])


def test_naming_a_flow_at_a_machine_is_refused():
    with pytest.raises(ValueError, match=r"^effect overflow acts at flow ports; carriage is of kind effort$"):
        compose(EMPS(), ["overflow@carriage"])


def test_a_level_has_a_unit_for_every_coefficient(tank):
    model = compose(tank, ["overflow", "linear_leak", "periodic_flow"])
    units = {p.name: p.unit for p in model.parameters}
    assert units["tank.overflow.k"] == units["tank.linear_leak.k"] == "m²/s"
    assert units["tank.periodic_flow.frequency"] == "Hz"
    assert {d.unit(tank.port("tank")) for d in (EFFORT, DAMPING, INERTIA)} == {"m³/s", "m²", "m²·s"}
    assert not any(name.endswith(".epsilon") for name in units)


def test_a_flow_port_has_no_acceleration_no_smoothing_and_no_load(tank):
    def own(law):
        parameters = (EffectParameter("c", EFFORT, "flow", nests=True),)
        return Effect("own", "flow", "own", "F", law, "a test", "none", parameters)

    for law in (lambda at: at.p.c * at.acceleration, lambda at: at.p.c * at.sign):
        with pytest.raises(ValueError, match="effect own: flow port tank has a level and a net flow, but no"):
            _ = compose(tank, [own(law)]).f
    with pytest.raises(ValueError, match="effect own: its flow at tank uses the rate that it changes"):
        _ = compose(tank, [own(lambda at: at.p.c * at.rate)]).f
    seen = compose(tank, [own(lambda at: at.p.c * at.velocity * at.position)])
    assert float(seen.efforts(0, [0.5], [1e-3], [0.02, 2.0])) == pytest.approx(2.0 * 0.05 * 0.5)
    with pytest.raises(ValueError, match="port tank: a flow port carries no load"):
        Port("tank", "flow", "m³/s", 1e-3, "m", load="a weight")
