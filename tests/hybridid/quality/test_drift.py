"""A free run that drifts by nature condemns no fit; any other does. All simulated."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.torture.pendulum import Pendulum
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.estimators import FitSettings, fit
from hybridid.estimators.problem import build_problem
from hybridid.model import compose
from hybridid.plants.plant import Motion, Plant
from hybridid.quality import judge
from hybridid.quality.drift import explained_over_horizons
from hybridid.quality.judge import _before_it_falls
from hybridid.quality.verdict import View
from hybridid.quality.words import worse_than_nothing
from hybridid.records.record import Channel, Record
from hybridid.validation.drift import growth, outputs_that_drift

DT, N = 0.1, 600


class Ball(Plant):
    """``q'' = b angle - F - k q``: a ball on a beam, with no spring unless one is told."""

    name, meaning, source = "ball", "a ball on a beam", "a test"
    states = (
        State("q", "m", scale=0.2, observed_by="position", derivative=0),
        State("v", "m/s", scale=0.2, observed_by="position", derivative=1),
    )
    inputs = (Signal("angle", "rad"),)
    outputs = (Signal("position", "m"), Signal("speed", "m/s"))
    parameters = (Parameter("b", "m/s²", 5.0, 0.01, 100.0), Parameter("k", "1/s²", 0.0, 0.0).fixed_at(0.0))
    ports = (Port("beam", "effort", "m/s²", 0.1, "m", 0.2, 0.2, 0.001),)

    def motion(self, x, u, p):
        return {"beam": Motion(position=x.q, velocity=x.v)}

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": p.b * u.angle - effort["beam"] - p.k * x.q}

    def output(self, x, u, p):
        return {"position": x.q, "speed": x.v}


class Position(Ball):
    """The same where the speed is not measured."""

    outputs = (Signal("position", "m"),)

    def output(self, x, u, p):
        return {"position": x.q}


def rolled(tilt=0.002, n_y=1):
    """A ball held near the middle by hand, on a beam whose foot stands ``tilt`` rad askew, which changes
    now and then; the angle that is recorded does not have it."""
    generator, q, v = np.random.default_rng(3), 0.0, 0.0
    askew = tilt * np.repeat(generator.choice([-1.0, 0.5], N // 50), 50)
    time, both, angle = DT * np.arange(N), np.empty((N, 2)), np.empty(N)
    for k in range(N):
        goal = 0.1 * np.sin(0.9 * time[k])
        angle[k] = np.clip(0.3 * (goal - q) - 0.5 * v, -0.05, 0.05)
        both[k] = q, v
        for _ in range(10):
            v += DT / 10 * 5.0 * (angle[k] + askew[k])
            q += DT / 10 * v
    both += generator.normal(0.0, 2e-4, both.shape)
    channels = (Channel("position", "m"), Channel("speed", "m/s"))[:n_y]
    return Record(
        "rolled", time, angle[:, None], both[:, :n_y], (Channel("angle", "rad"),), channels, simulated=True
    )


def test_a_free_run_of_a_plant_that_integrates_is_no_accusation():
    record, model = rolled(), compose(Position(), ["viscous"])
    found = judge(model, [record], fit(model, [record], FitSettings(horizon=30)))
    horizons, free = found.views
    assert free.worse_than_nothing
    assert horizons.rmse < 0.3 * horizons.nothing
    assert (found.verdict, [one.kind for one in found.findings]) == ("incomplete", ["incomplete"])
    (said,) = (one.said for one in found.advice if one.kind == "drift")
    assert said.startswith("the free run drifts (position: RMSE ")
    assert said.endswith("small errors add up; its errors over horizons of 3 s judge it")


def test_a_sound_fit_tells_what_adds_up_in_free_run():
    """A beam askew by too little to show within one horizon."""
    record, model = rolled(tilt=1e-5), compose(Position(), ["viscous"])
    found = judge(model, [record], fit(model, [record], FitSettings(horizon=30)))
    assert found.verdict == "sound"
    assert not found.views[1].worse_than_nothing
    assert "; but in free run, where small errors add up, it leaves " in found.said


@pytest.mark.parametrize(("left", "told"), [(0.04, True), (0.8, False)])
def test_a_free_run_that_diverges_beside_good_horizons_leads_to_trace(left, told):
    horizons = View("angle", "rad", 1.0, left, 1 - left**2, 0.9)
    free = View("angle", "rad", None, 11.3, -160.0, 0.9)
    said = worse_than_nothing([free], explained_over_horizons([horizons, free]))
    assert ("over horizons it explains most of the motion" in said) is told
    assert said.endswith("hybridid trace looks for what the model lacks") is told


def test_a_reversed_sign_is_no_matter_of_drift():
    """The same ball pushed the wrong way: it has nothing that brings it back, and is wrong all the same."""
    reversed_sign = {"b": {"upper": -0.01, "lower": -100.0, "guess": -5.0}}
    record, model = rolled(), compose(Position(), ["viscous"], reversed_sign)
    found = judge(model, [record], fit(model, [record], FitSettings(horizon=30)))
    assert found.verdict == "wrong"
    assert "sign" in {one.kind for one in found.findings}
    assert not [one for one in found.advice if one.kind == "drift"]


@pytest.mark.parametrize(
    ("values", "drift"),
    [
        ({}, [True, True]),  # a double integrator: an offset of the force reaches both
        ({"beam.viscous.f_v": 2.0}, [True, False]),  # friction holds the speed
        ({"k": 1.0, "beam.viscous.f_v": 0.01}, [False, False]),  # a spring brings it back
        ({"k": 1e-5, "beam.viscous.f_v": 0.0}, [True, True]),  # not within this record
        ({"k": -1.0, "beam.viscous.f_v": 0.0}, [True, True]),  # it rolls off a hump
    ],
)
def test_an_output_drifts_if_nothing_brings_it_back_within_the_record(values, drift):
    model = compose(Ball(), ["viscous"])
    p = model.values({"beam.viscous.f_v": 0.0, **values})
    assert outputs_that_drift(model, p, [rolled(n_y=2)]) == drift


class Hump(Position):
    """The same ball on a hump, which it rolls off: ``q'' = b angle - F + h q``."""

    parameters = (Parameter("b", "m/s²", 5.0, 0.01, 100.0), Parameter("h", "1/s²", 2.0, 0.0, 100.0))

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": p.b * u.angle - effort["beam"] + p.h * x.q}


def held(n=3000, dt=0.02):
    """A ball that a loop holds on a hump, with h = 4 /s² and friction."""
    generator, q, v = np.random.default_rng(4), 0.0, 0.0
    time, position, angle = dt * np.arange(n), np.empty(n), np.empty(n)
    for k in range(n):
        angle[k] = 4.0 * (0.1 * np.sin(0.9 * time[k]) + 0.05 * np.sin(3 * time[k]) - q) - 1.0 * v
        position[k] = q
        for _ in range(20):
            v += dt / 20 * (5.0 * angle[k] + 4.0 * q - 0.3 * v)
            q += dt / 20 * v
    position += generator.normal(0.0, 1e-4, n)
    channels = (Channel("angle", "rad", "zoh"),), (Channel("position", "m"),)
    return Record("held", time, angle[:, None], position[:, None], *channels, simulated=True)


def test_a_free_run_of_an_unstable_machine_is_no_accusation():
    record, model = held(), compose(Hump(), ["viscous"])
    estimate = fit(model, [record], FitSettings(horizon=50))
    assert estimate.values["h"] == pytest.approx(4.0, rel=0.05)
    found = judge(model, [record], estimate)
    horizons, free = found.views
    assert free.worse_than_nothing
    assert horizons.rmse < 0.05 * horizons.nothing
    assert found.verdict == "sound"
    (said,) = (one.said for one in found.advice if one.kind == "drift")
    assert "a small error grows e-fold in 540 ms" in said
    assert not [one for one in found.advice if one.kind == "horizon"]
    rate = growth(model, model.values(estimate.values), [record])
    assert rate == pytest.approx(-0.15 + np.sqrt(0.15**2 + 4.0), rel=0.05)
    assert growth(model, model.values({"h": 0.0}), [record]) == 0.0


def test_an_unstable_machine_is_not_fitted_in_one_run():
    record, model = held(), compose(Hump(), ["viscous"])
    found = judge(model, [record], fit(model, [record], FitSettings()))
    (said,) = (one.said for one in found.advice if one.kind == "horizon")
    assert "a small error grows e-fold in " in said
    assert "no initial state is exact enough for a run of 60 s; estimator.horizon=" in said


def test_readings_are_tried_over_pieces_in_which_an_unstable_machine_does_not_fall():
    """Over longer ones any reading that makes it stable would seem right."""
    record, model = held(), compose(Hump(), ["viscous"])
    problem = build_problem(model, [record], None, 1)
    for h, samples in ((4.0, round(5.0 / 2.0 / record.dt)), (0.0, record.n)):
        p = model.values({"h": h, "beam.viscous.f_v": 0.0})
        assert _before_it_falls(problem, p).windows.horizon == samples


def test_a_pendulum_does_not_drift():
    model, time = compose(Pendulum(), ["viscous"]), 0.02 * np.arange(400)
    record = Record(
        "swung", time, np.zeros((400, 1)), np.sin(3 * time)[:, None],
        (Channel("torque", "N·m", "zoh"),), (Channel("angle", "rad"),), simulated=True,
    )  # fmt: skip
    assert outputs_that_drift(model, model.values(), [record]) == [False]
