"""In a free decay, frictions over the amplitude and over the time are one class."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.advice.decay import swing
from hybridid.effects.library import effect_named
from hybridid.records.record import Channel, Record
from hybridid.trace.candidates import Candidate
from hybridid.trace.decay_class import over_time, takes_power, with_decay_classes
from hybridid.trace.run import _of_one_decay
from hybridid.trace.search import Accepted, Search, Step
from hybridid.trace.trial import PASSED, REJECTED, Trial
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


def found(*trials: Trial) -> Search:
    """A search whose only step accepted the first of ``trials``."""
    accepted = Accepted(trials[0], (trials[0],), ())
    final = SimpleNamespace()
    return Search((Step(final, trials, accepted),), final, (accepted,), "")


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
    assert ids(with_decay_classes(found(*TRIALS), [decay()])) == ["friction_drift", "quadratic_drag"]
    other = with_decay_classes(found(TRIALS[1], TRIALS[0], *TRIALS[2:]), [decay()])
    assert ids(other) == ["quadratic_drag", "friction_drift", "warming_friction"]


def test_nothing_changes_where_the_machine_is_driven_or_a_spring_was_found():
    driven = found(*TRIALS)
    assert with_decay_classes(driven, [decay(torque=0.1)]) is driven
    assert ids(with_decay_classes(found(TRIALS[3], *TRIALS[:3]), [decay()])) == ["linear_stiffness"]


@pytest.mark.parametrize(
    ("verdict", "then"), [("effect_found", "ambiguous"), ("law_proposed", "law_proposed")]
)
def test_the_verdict_is_no_longer_that_one_effect_was_found(verdict, then):
    concluded = Conclusion(verdict, found(*TRIALS), {}, (), (), (), {}, 1.0)
    assert _of_one_decay(concluded, [decay()]).verdict == then
    assert _of_one_decay(concluded, [decay(torque=0.1)]).verdict == verdict
