"""In a free decay, frictions over the amplitude and over the time are one class."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.advice.decay import swing
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.plant import Motion, Plant
from hybridid.records.record import Channel, Record
from hybridid.trace.candidates import Candidate
from hybridid.trace.cautions.decay_class import in_their_place, over_time, takes_power, with_decay_classes
from hybridid.trace.horizons.evidence import Comparison
from hybridid.trace.horizons.score import Score
from hybridid.trace.rules import Rules
from hybridid.trace.run import _of_one_decay
from hybridid.trace.search.steps import Accepted, Search, Step
from hybridid.trace.trials.trial import PASSED, REJECTED, UNIDENTIFIABLE, Trial
from hybridid.trace.verdict import Conclusion

PERIOD = 0.5  # s


def decay(torque: float = 0.0) -> Record:
    """A swing of 2 Hz over 20 s, simulated; driven where there is a ``torque``."""
    t = np.arange(0, 20, 0.01)
    angle = np.exp(-0.1 * t) * np.cos(2 * np.pi * t / PERIOD)
    driven = (torque * np.sin(3 * t))[:, None]
    channels = (Channel("torque", "N·m"),), (Channel("angle", "rad"),)
    return Record("decay", t, driven, angle[:, None], *channels, simulated=True)


def tried(name: str, status: str = PASSED, port: str = "pivot", **values: float) -> Trial:
    own = {f"{port}.{name}.{p}": value for p, value in values.items()}
    return Trial(Candidate(effect_named(name), port), SimpleNamespace(values=own), None, status=status)


class Swing(Plant):
    """``q'' = -G q - F``."""

    name, meaning, source = "swing", "a swing", "this test"
    states = (
        State("q", "rad", scale=1.0, observed_by="angle", derivative=0),
        State("w", "rad/s", scale=1.0, observed_by="angle", derivative=1),
    )
    inputs = ()
    outputs = (Signal("angle", "rad"),)
    parameters = (Parameter("G", "1/s²", guess=160.0),)
    ports = (Port("pivot", "effort", "rad/s²", 1.0, position_unit="rad", epsilon=0.01),)

    def motion(self, x, u, p):
        return {"pivot": Motion(position=x.q, velocity=x.w)}

    def derivative(self, x, u, p, effort):
        return {"q": x.w, "w": -p.G * x.q - effort["pivot"]}

    def output(self, x, u, p):
        return {"angle": x.q}


def scored(rmse: float) -> Score:
    """Twenty horizons of 100 samples with errors of about ``rmse``."""
    spread = rmse**2 * (1 + 0.1 * np.random.default_rng(0).normal(size=(20, 1)))
    squares, samples = 100 * spread, np.full((20, 1), 100)
    return Score(squares, samples, squares, samples, -50 * spread, np.ones(1), np.ones(1))


def found(*trials: Trial, rmse: float = 1.0) -> Search:
    """A search whose only step accepted the first of ``trials``, beside the declared ``viscous``."""
    accepted = Accepted(trials[0], (trials[0],), ())
    model = compose(Swing()).plus(effect_named("viscous"), "pivot")
    model = model.plus(trials[0].candidate.effect, "pivot")
    values = {p.name: p.guess for p in model.parameters}
    first = SimpleNamespace(score=scored(3.0))
    final = SimpleNamespace(model=model, values=values, score=scored(rmse), numerics=None)
    return Search((Step(first, trials, accepted),), final, (accepted,), "")


def context(rmse: float = 9.0) -> SimpleNamespace:
    """A context in which the powers of the amplitude together leave ``rmse``; it keeps their ``names``."""
    asked = SimpleNamespace(split=None, rules=Rules(), names=[])

    def one(function, model, split, starts, before, numerics):
        asked.names = [term.name for term in model.terms]
        assert all(set(start) == {p.name for p in model.parameters} for start in starts)
        return SimpleNamespace(score=scored(rmse))

    asked.one = one
    return asked


def ids(searched: Search) -> list[str]:
    return [trial.candidate.effect.id for trial in searched.accepted[0].alike]


def test_the_period_of_a_swing():
    assert swing(decay()) == pytest.approx(PERIOD, rel=0.01)


@pytest.mark.parametrize(
    ("name", "power"),
    [("coulomb", True), ("quadratic_drag", True), ("friction_drift", True), ("dahl", True),
     ("warming_friction", True), ("linear_stiffness", False), ("cubic_stiffness", False), ("offset", False)],
)  # fmt: skip
def test_what_follows_the_velocity_takes_power(name, power):
    assert takes_power(effect_named(name)) is power


def test_what_follows_the_time():
    assert over_time(tried("friction_drift"), PERIOD)
    assert over_time(tried("warming_friction", tau=5.0), PERIOD)
    assert not over_time(tried("warming_friction", tau=0.3), PERIOD)
    assert not over_time(tried("quadratic_drag"), PERIOD)
    assert not over_time(tried("dahl"), PERIOD)


TRIALS = (
    tried("friction_drift"),
    tried("quadratic_drag"),
    tried("warming_friction", tau=5.0),
    tried("linear_stiffness"),
    tried("coulomb", REJECTED),
    tried("stribeck", port="elsewhere"),
)


def test_a_law_over_time_stands_beside_those_over_the_amplitude_and_the_reverse():
    """A spring, what was refused and what acts elsewhere are no part of the class, nor others over time."""
    assert ids(with_decay_classes(found(*TRIALS), [decay()], context())) == [
        "friction_drift",
        "quadratic_drag",
    ]
    other = with_decay_classes(found(TRIALS[1], TRIALS[0], *TRIALS[2:]), [decay()], context())
    assert ids(other) == ["quadratic_drag", "friction_drift", "warming_friction"]


def test_nothing_changes_where_the_machine_is_driven_or_a_spring_was_found():
    driven = found(*TRIALS)
    assert with_decay_classes(driven, [decay(torque=0.1)], context()) is driven
    assert ids(with_decay_classes(found(TRIALS[3], *TRIALS[:3]), [decay()], context())) == [
        "linear_stiffness"
    ]


@pytest.mark.parametrize(
    ("verdict", "then"), [("effect_found", "ambiguous"), ("law_proposed", "law_proposed")]
)
def test_the_verdict_is_no_longer_that_one_effect_was_found(verdict, then):
    concluded = Conclusion(verdict, found(*TRIALS), {}, (), (), (), 1.0, 1.0)
    assert _of_one_decay(concluded, [decay()], context()).verdict == then
    assert _of_one_decay(concluded, [decay(torque=0.1)], context()).verdict == verdict


def test_powers_of_the_amplitude_that_explain_as_much_together_are_in_the_class():
    asked = context(rmse=1.0)
    widened = with_decay_classes(found(*TRIALS), [decay()], asked)
    assert asked.names == ["pivot.viscous", "pivot.coulomb", "pivot.quadratic_drag"]
    assert ids(widened) == ["friction_drift", "coulomb", "quadratic_drag"]
    said = " In the place of friction_drift, coulomb and quadratic_drag explain these records as well."
    assert in_their_place(widened) == said


def test_powers_that_explain_less_are_not():
    widened = with_decay_classes(found(*TRIALS), [decay()], context(rmse=1.5))
    assert ids(widened) == ["friction_drift", "quadratic_drag"]
    assert in_their_place(widened) == ""


def test_nor_are_they_tried_where_no_law_over_the_time_was_accepted():
    asked = context(rmse=1.0)
    assert ids(with_decay_classes(found(TRIALS[1], *TRIALS[3:]), [decay()], asked)) == ["quadratic_drag"]
    assert asked.names == []


def test_in_a_run_down_all_efforts_that_explain_half_as_much_are_one_class():
    """Speed, time and angle fall and grow together: a drag that is collinear with what is declared, too."""
    t = np.arange(0, 20, 0.1)
    channels = (), (Channel("speed", "rad/s"),)
    run = Record("run", t, np.zeros((len(t), 0)), np.exp(-0.05 * t)[:, None], *channels, simulated=True)
    trials = [
        weighed("position_damping", 0.60, 1e-4),
        replace(weighed("quadratic_drag", 0.62, 1e-3), status=UNIDENTIFIABLE),
        weighed("friction_drift", 0.20, 1e-4),
        replace(weighed("cogging", 0.60, 1e-4), not_shown="three periods are needed"),
        weighed("coulomb", 0.60, 0.5),
    ]
    one = Accepted(trials[0], (trials[0],), ())
    found = Search((Step(SimpleNamespace(), tuple(trials), one),), SimpleNamespace(), (one,), "")
    (widened,) = with_decay_classes(found, [run], SimpleNamespace(rules=Rules())).accepted
    assert [t.candidate.effect.id for t in widened.alike] == ["position_damping", "quadratic_drag"]


def weighed(name: str, gain: float, p: float) -> Trial:
    """A trial that takes ``gain`` of an error of one."""
    refit = SimpleNamespace(score=SimpleNamespace(loss=1.0 - gain), values={})
    evidence = Comparison(gain, p, 0.0)
    return Trial(Candidate(effect_named(name), "pivot"), refit, evidence, p_adjusted=p, status=PASSED)
