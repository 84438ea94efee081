"""Advice is told where it is due, and only there. All records here are simulated."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.torture.pendulum import Pendulum
from hybridid.advice.decay import coasts, free_decay, settles, undriven
from hybridid.advice.ranges import _without_effect
from hybridid.advice.relaxation import relaxation
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.plant import Load, Motion, Plant
from hybridid.quality import judge
from hybridid.records.record import Channel, Record
from pipelines.new.templates.spindle import Spindle

NOISE = 1e-5


def told(kind, model, records, settings=None, held_out=()):
    estimate = fit(model, records, settings)
    return [one.said for one in judge(model, records, estimate, held_out).advice if one.kind == kind]


@pytest.fixture(scope="module")
def record(carriage, noise):
    return carriage.record(noise=noise(600, NOISE, seed=4))


class Motor(Plant):
    """``J q'' = k_t (u - k_t q')/R - F``: torque and back-EMF tell k_t/R and k_t²/R, this beside friction."""

    name, meaning, source = "motor", "a motor", "this test"
    states = (
        State("q", "rad", scale=1.0, observed_by="angle", derivative=0),
        State("w", "rad/s", scale=5.0, observed_by="angle", derivative=1),
    )
    inputs = (Signal("u", "V"),)
    outputs = (Signal("angle", "rad"),)
    parameters = (
        Parameter("J", "kg·m²", guess=0.01, lower=1e-4, upper=1.0),
        Parameter("k_t", "N·m/A", guess=0.5, lower=0.01, upper=10.0),
        Parameter("R", "Ω", guess=3.0, lower=2.0, upper=5.0),
    )
    ports = (
        Port("shaft", "effort", "N·m", 0.1, "rad", 1.0, velocity_scale=5.0, epsilon=0.05),
        Port("u", "input", "V", 1.0),
        Port("angle", "output", "rad", 1.0),
    )

    def motion(self, x, u, p):
        return {"shaft": Motion(position=x.q, velocity=x.w)}

    def derivative(self, x, u, p, effort):
        torque = p.k_t * (u.u - p.k_t * x.w) / p.R
        return {"q": x.w, "w": (torque - effort["shaft"]) / p.J}

    def output(self, x, u, p):
        return {"angle": x.q}


def turned(resistance=6.5, n=800, dt=0.01, seed=5):
    """A motor of 6.5 Ω, outside the bounds: its true friction and inertia are those of 0.02 N·m·s/rad."""
    u = np.repeat(np.random.default_rng(seed).uniform(-6, 6, n // 20), 20)
    channels = (Channel("u", "V", "zoh"),), (Channel("angle", "rad"),)
    angle = turned_by(u, resistance, dt)
    return Record("turned", dt * np.arange(n), u[:, None], angle[:, None], *channels, simulated=True)


def turned_by(u, resistance=6.5, dt=0.01):
    """The angle of that motor under the voltage ``u`` (n,), with noise."""
    n = len(u)
    x, angle = np.zeros(2), np.empty(n)
    for k in range(n):
        angle[k] = x[0]
        rate = lambda _, x, u=u[k]: [  # noqa: E731
            x[1], (0.2 * (u - 0.2 * x[1]) / resistance - 0.05 * x[1]) / 0.02
        ]  # fmt: skip
        x = solve_ivp(rate, (0, dt), x, rtol=1e-9, atol=1e-11).y[:, -1]
    return angle + np.random.default_rng(6).normal(0, 1e-3, n)


def test_a_parameter_at_its_bound_is_told_with_the_one_it_runs_along():
    """The back-EMF of k_t²/R is small beside a friction that is known: the record tells little but k_t/R."""
    model = compose(Motor(), ["viscous"], {"J": {"fixed": 0.02}, "shaft.viscous.f_v": {"fixed": 0.05}})
    (said,) = told("bound", model, [turned()])
    assert said.startswith("R is at its bound and collinear with k_t (correlation of size 0.99")
    assert said.endswith("fix one of the two at a value that you know, as in parameters.k_t.fixed=...")


def test_a_bound_alone_is_no_matter_of_two(make_model, record):
    tight = make_model(adjust={"M": {"lower": 97.0, "upper": 150.0}})
    estimate = fit(tight, [record])
    assert [p.name for p in estimate.parameters if p.at_bound] == ["M"]
    assert told("bound", tight, [record]) == []


def test_a_delay_that_may_take_few_samples_is_told_with_the_keys_that_widen_it():
    """The motor at 50 ms a sample, its voltage 0.1 s late: the library's delay ends at 10 ms."""
    prompt = turned(n=2000)
    late = np.concatenate([np.zeros(10), prompt.inputs[:-10, 0]])
    angle = turned_by(late)[::5, None]
    record = replace(prompt, time=prompt.time[::5], inputs=prompt.inputs[::5], outputs=angle)
    known = {"J": {"fixed": 0.02}, "R": {"fixed": 6.5, "upper": 7.0}, "k_t": {"fixed": 0.2}}
    model = compose(Motor(), ["viscous", "input_delay@u"], known)
    (said,) = told("bound", model, [record])
    assert said == (
        "u.input_delay.delay ends at its bound of 0.01 s, fewer than 10 samples of 0.05 s: the library's "
        "bounds are those of samples of 1 ms; parameters.u.input_delay.delay.upper=0.5 "
        "parameters.u.input_delay.window.guess=0.5 allows 10"
    )
    wider = {**known, "u.input_delay.delay": {"upper": 0.5}, "u.input_delay.window": {"guess": 0.5}}
    estimate = fit(compose(Motor(), ["viscous", "input_delay@u"], wider), [record])
    assert estimate.values["u.input_delay.delay"] == pytest.approx(0.1, abs=0.03)


def test_a_friction_that_is_not_there_is_told_nothing(make_model, record):
    """Its bound of zero is physics."""
    model = make_model(("viscous", "coulomb", "offset", "quadratic_drag"))
    assert told("bound", model, [record]) == []


@pytest.mark.parametrize("effects", [("viscous", "coulomb", "offset"), ("viscous", "offset")])
def test_parameters_that_share_a_scale_are_told(make_model, record, effects):
    (said,) = told("scale", make_model((*effects, "input_gain")), [record])
    names = ", ".join(
        f"carriage.{e}.{n}" for e, n in (("viscous", "f_v"), ("coulomb", "f_c")) if e in effects
    )
    assert said.startswith(f"M, {names} and carriage.offset.offset share one free scale")
    assert "with force.input_gain.g to match" in said
    assert said.endswith("as in parameters.M.fixed=...")


def test_a_scale_that_is_fixed_is_told_nothing(make_model, record):
    model = make_model(("viscous", "coulomb", "offset", "input_gain"), {"M": {"fixed": 95.0}})
    assert told("scale", model, [record]) == []


def test_parameters_of_which_only_a_sum_is_known_share_no_scale(make_model, record):
    model = make_model(("viscous", "coulomb", "offset", "added_inertia"))
    assert not all(p.identifiable for p in fit(model, [record]).parameters)
    assert told("scale", model, [record]) == []


def test_a_pendulum_that_swings_freely_has_a_free_scale_of_its_torques():
    class Free(Pendulum):
        inputs = ()
        parameters = (
            Parameter("J", "kg·m²", guess=0.02, lower=1e-4, upper=10.0),
            Parameter("G", "N·m", guess=0.9, lower=1e-3, upper=100.0),
        )

        def derivative(self, x, u, p, effort):
            return {"q": x.w, "w": (-p.G * ca.sin(x.q) - effort["pivot"]) / p.J}

    swing = decaying(0.6, "swing")
    model = compose(Free(), ["viscous"])
    (said,) = told("scale", model, [swing])
    assert said.startswith(
        "J, G and pivot.viscous.f_v share one free scale: all of them times one factor leave"
    )
    assert "to match" not in said
    known = compose(Free(), ["viscous"], {"J": {"fixed": 0.02}})
    assert told("scale", known, [swing]) == []
    (decay,) = told("decay", known, [swing])
    assert decay.startswith("amplitude and time cannot be told apart in swing: a free decay of angle from ")


def decaying(amplitude, name, n=3000, dt=0.01, torque=None):
    """A pendulum with viscous friction, let go at ``amplitude``."""

    def rate(t, x):
        push = 0.0 if torque is None else torque(t)
        return [x[1], (push - 0.9 * np.sin(x[0]) - 0.004 * x[1]) / 0.02]

    time = dt * np.arange(n)
    angle = solve_ivp(rate, (0, time[-1]), [amplitude, 0.0], t_eval=time, rtol=1e-9, atol=1e-11).y[0]
    angle += np.random.default_rng(1).normal(0, 1e-4, n)
    inputs = np.empty((n, 0)) if torque is None else np.array([[torque(t)] for t in time])
    channels = () if torque is None else (Channel("torque", "N·m"),)
    return Record(name, time, inputs, angle[:, None], channels, (Channel("angle", "rad"),), simulated=True)


@pytest.mark.parametrize(
    ("after", "driven", "settled"), [(25.0, False, True), (5.0, False, False), (25.0, True, False)]
)
def test_a_record_has_settled_where_it_varies_by_a_fifth_of_before(after, driven, settled):
    """A swing of 30 s that decays with a time constant of 10 s; a driven one may start again."""
    swing = decaying(0.6, "swing", torque=(lambda t: 1e-9 * np.sin(t)) if driven else None)
    assert settles(swing, after) is settled


@pytest.mark.parametrize(
    ("torque", "coasting"),
    [
        (lambda t: np.where(t < 2.0, 0.1, 0.0), True),
        (lambda t: np.where(t < 28.0, 0.1, 0.0), False),
        (lambda t: 0.1 * np.sin(t), False),
        (None, False),
    ],
)
def test_a_record_coasts_where_an_input_that_drove_it_changes_no_more(torque, coasting):
    """Of 30 s the last 9: after a pulse, in it, under a sine, and of what was never driven."""
    assert coasts(decaying(0.6, "swing", torque=torque), 21.0) is coasting


def test_decays_from_one_amplitude_are_told_and_from_two_are_not():
    first, again, smaller = decaying(0.6, "first"), decaying(0.58, "again"), decaying(0.05, "smaller")
    assert len(list(free_decay([first]))) == 1
    (said,) = free_decay([first, again])
    assert "first and again" in said.said
    assert list(free_decay([first, smaller])) == []


def test_a_machine_that_is_driven_or_does_not_swing_is_no_decay(record):
    assert list(free_decay([decaying(0.6, "driven", torque=lambda t: 0.2 * np.sin(4 * t))])) == []
    assert list(free_decay([record])) == []
    still = replace(decaying(0.6, "still"), outputs=np.exp(-np.arange(3000) / 900)[:, None])
    assert list(free_decay([still])) == []


def test_a_held_out_record_that_leaves_what_was_fitted_is_told(make_model, record):
    harder = replace(record, name="harder", inputs=1.3 * record.inputs, warnings=())
    (said,) = told("range", make_model(), [record], held_out=[record, harder])
    assert said.startswith("record harder leaves what was fitted: force −10")
    assert ", fitted −7" in said
    assert "position" not in said


def test_speed_and_load_are_looked_at_too(pressed, record):
    """The carriage pressed by a spring: at half the speed it was fitted, it is held out at the whole."""
    model = compose(pressed, ["viscous"], {"carriage.epsilon": {"guess": 3e-3}})
    slow = replace(record, name="slow", outputs=0.5 * record.outputs, warnings=())
    (said,) = told("range", model, [slow], held_out=[record])
    assert "speed at carriage" in said
    assert "load at carriage" in said
    assert "position" not in said, "the carriage is the same everywhere"
    assert "force" not in said


@pytest.mark.parametrize(("effects", "idle"), [(["viscous"], {"angle"}), (["viscous", "cogging"], set())])
def test_an_input_on_which_nothing_depends_has_no_range(effects, idle):
    """A spindle whose speed is measured has its angle as an input, for effects that act at an angle."""
    assert _without_effect(compose(Spindle(), effects)) == idle


def test_a_position_is_a_range_where_something_depends_on_it(make_model, record):
    slow = replace(record, name="slow", outputs=0.5 * record.outputs, warnings=())
    (said,) = told("range", make_model(("viscous", "linear_stiffness")), [slow], held_out=[record])
    assert "position" in said


def test_a_load_by_a_parameter_with_a_value_for_each_group_is_that_of_the_group(pressed, record):
    class Hung(type(pressed)):
        def loads(self, x, u, p):
            return {"carriage": Load(drive=u.force, load=-9.81 * p.M + 0 * x.q, level=1.0)}

    def of_group(name, light):
        weights = {"M[light]": float(light), "M[heavy]": float(not light)}
        return replace(record, name=name).with_constants(weights, dict.fromkeys(weights, "1"))

    heavy = {"M": {"lower": 10.0, "upper": 500.0}, "carriage.epsilon": {"guess": 3e-3}}
    model = compose(Hung(), ["viscous", "coulomb", "offset"], heavy, groups={"M": ("light", "heavy")})
    fitted, other = of_group("fitted", light=True), of_group("other", light=False)
    (said,) = told("range", model, [fitted], held_out=[other])
    assert said.startswith("record other leaves what was fitted: load at carriage −")
    assert told("range", model, [fitted], held_out=[replace(fitted, name="again")]) == []


def test_records_within_what_was_fitted_are_told_nothing(make_model, record):
    little_more = replace(record, name="more", inputs=1.05 * record.inputs, warnings=())
    assert told("range", make_model(), [record], held_out=[record, little_more]) == []


def test_a_sample_that_stands_out_is_no_range(make_model, carriage):
    long = carriage.record(n=6000)
    spike = np.array(long.outputs)
    spike[700] += 10.0
    held_out = [replace(long, name="spiked", outputs=spike, warnings=())]
    model = make_model(("viscous", "coulomb", "linear_stiffness"))
    said = told("range", model, [long], FitSettings(horizon=200), held_out)
    assert all("position" not in one for one in said)


def cooling(start, name, n=3000):
    """A body that cools to 20 °C."""
    made = decaying(0.6, name, n)
    return replace(made, outputs=20 + (start - 20) * np.exp(-np.arange(n) / 900)[:, None])


def test_what_only_cools_does_not_tell_temperature_from_time_and_from_two_temperatures_it_does():
    (said,) = relaxation([cooling(80, "mug")])
    assert said.said.startswith("angle and time cannot be told apart in mug: it only goes from 7")
    assert len(list(relaxation([cooling(80, "mug"), cooling(79, "again")]))) == 1
    assert list(relaxation([cooling(80, "mug"), cooling(30, "cooler")])) == []
    still = cooling(80, "drum")
    way = still.dt * np.cumsum(0.5 * (still.outputs[1:] + still.outputs[:-1]), axis=0)
    turning = replace(still, inputs=np.vstack([[[0.0]], way]), input_channels=(Channel("way", "m"),))
    assert len(list(relaxation([turning]))) == 1, "an angle that the speed makes drives nothing"
    assert undriven(turning)
    assert not undriven(replace(turning, inputs=turning.inputs**2))
    assert list(relaxation([decaying(0.6, "swing")])) == []
    assert list(relaxation([decaying(0.6, "driven", torque=lambda t: 0.2 * np.sin(4 * t))])) == []


@pytest.fixture(scope="module")
def light(carriage_like, noise):
    return carriage_like(M=95.0).record(noise=noise(600, NOISE, seed=4), name="light")


@pytest.mark.parametrize(
    ("truth", "expected"),
    [
        ({"M": 125.0}, "M is 94.98 kg in light and 125"),
        ({"offset": 5.0}, "carriage.offset.offset is −3."),
        ({"M": 95.0}, ""),
    ],
)
def test_recordings_that_one_set_of_parameters_does_not_fit_are_told(
    make_model, carriage_like, light, noise, truth, expected
):
    other = carriage_like(**truth).record(noise=noise(600, NOISE, seed=5), name="other")
    lines = told("recordings", make_model(), [light, other], FitSettings(horizon=100))
    assert len(lines) == bool(expected)
    if lines:
        (said,) = lines
        assert said.startswith("the recordings disagree: if each has its own ")
        assert expected in said
        assert " in light and " in said
        name = expected.split()[0]
        assert f"go on with parameters.{name}.by=record fit.records=null trace.held_out=null, " in said


def test_what_is_missing_in_both_recordings_alike_is_no_disagreement(make_model, carriage_like, noise):
    both = [carriage_like(df_v=80.0).record(noise=noise(600, NOISE, seed=k), name=f"run {k}") for k in (4, 5)]
    assert told("recordings", make_model(), both, FitSettings(horizon=100)) == []


def test_one_recording_does_not_disagree(make_model, carriage_like):
    lacks = carriage_like(df_v=80.0).record()
    assert told("recordings", make_model(), [lacks], FitSettings(horizon=100)) == []
