"""What a poor sensor hides in the loss is found by the good one. All records here are simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.advice.unequal import unequal_outputs
from hybridid.declarations import Signal
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.channel import Channel
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import by_blocks
from hybridid.trace.noise_floor.weighed import hidden_by_noise
from hybridid.trace.refits.refit import refit
from hybridid.trace.run import trace
from hybridid.trace.search.steps import NO_ROOM
from hybridid.trace.search.stops import nothing_to_seek

NOISE = np.array([2e-5, 1e-2])
"""An encoder and a laser, both of the carriage's position, in m."""


class TwoSensors(EMPS):
    """EMPS with a laser beside its encoder."""

    name = "two_sensors"
    outputs = (*EMPS.outputs, Signal("laser", "m"))

    def output(self, x, u, p):
        return {"position": x.q, "laser": x.q}


@pytest.fixture(scope="module")
def record(carriage):
    """Twelve seconds of a carriage on which a constant force of -3.2 N acts."""
    one = carriage.record(2400)
    outputs = np.tile(one.outputs, 2) + np.random.default_rng(3).normal(0, NOISE, (2400, 2))
    channels = (*one.output_channels, Channel("laser", "m"))
    return replace(one, outputs=outputs, output_channels=channels, absent=None, warnings=())


def declared(record, noise):
    channels = zip(record.output_channels, noise, strict=True)
    return replace(record, output_channels=tuple(replace(c, noise=std) for c, std in channels))


@pytest.fixture(scope="module")
def traced(record):
    def of(one):
        return trace(
            compose(TwoSensors(), ["viscous", "coulomb"]),
            [one],
            effects=["offset"],
            laws=False,
            variables=("velocity",),
        )

    return of


def test_what_the_poor_sensor_hides_is_found_by_the_good_one(traced, record):
    """The records tell the noise of both, and the trace counts by it."""
    found = traced(record)
    (offset,) = found.accepted
    assert offset.parameters["offset"].value == pytest.approx(-3.2, abs=3 * offset.parameters["offset"].std)
    assert [one.value for one in found.weights.values()] == pytest.approx(NOISE, rel=0.3)
    assert "Each output's errors count in multiples of its sensor's noise" in found.words


def test_declared_noise_is_taken_as_it_is(traced, record):
    found = traced(declared(record, NOISE))
    assert [one.effect for one in found.accepted] == ["offset"]
    assert found.weights == {}
    assert "Beware: position" not in found.words


def test_noise_that_makes_little_of_the_loss_weighs_nothing(record):
    """A model whose errors are far above the noise of both sensors keeps its weights; advice tells others."""
    model = compose(TwoSensors(), ["viscous", "coulomb"])
    context = Context(by_blocks([record], 120), ())
    base = refit(model, context.split)
    assert hidden_by_noise(base, context).keys() == {"position", "laser"}
    far = replace(base, score=replace(base.score, squares=100 * base.score.squares))
    assert hidden_by_noise(far, context) == {}
    (told,) = unequal_outputs([record])
    assert told.said.startswith("position is measured")


@pytest.fixture(scope="module")
def hidden(record):
    """Over standard deviations, the loss is that of the laser's noise; the encoder shows far more."""
    context = Context(by_blocks([record], 120), ())
    return context, refit(compose(TwoSensors(), ["viscous", "coulomb"]), context.split)


def test_a_model_meets_the_noise_in_each_output_or_not_at_all(hidden):
    context, base = hidden
    noise = context.noise.beside(base.score)
    assert base.score.loss <= context.rules.near_floor * np.sqrt(np.mean((noise / base.score.scale) ** 2))
    assert not context.meets_noise(base.score)


def test_where_the_noise_leaves_no_room_no_effect_could_be_worth_it(hidden):
    """The true effect takes what the encoder shows of it, and too little of the loss to pass."""
    context, base = hidden
    complete = refit(compose(TwoSensors(), ["viscous", "coulomb", "offset"]), context.split)
    found = compare(base.score, complete.score)
    assert found.largest > 2 * context.rules.worth
    assert found.gain < context.rules.worth
    assert context.noise_leaves_no_room(base.score)
    assert nothing_to_seek(base, (), context) == NO_ROOM
    assert nothing_to_seek(base, (object(),), context) != NO_ROOM, "what was accepted is judged as before"
    noiseless = replace(context, rules=replace(context.rules, near_floor=0.0))
    assert not noiseless.noise_leaves_no_room(base.score), "the noise is less than it seems"


def test_a_larger_error_leaves_room(hidden):
    context, base = hidden
    room = 1.01 / (1.0 - context.rules.worth) ** 2
    far = replace(base.score, squares=room * base.score.squares)
    assert not context.noise_leaves_no_room(far)
