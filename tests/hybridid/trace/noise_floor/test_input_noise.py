"""A force sensor's noise leaves an error that looks like something missing, and is told instead."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from hybridid.effects.library import effect_named
from hybridid.plain import plain, schema
from hybridid.trace import over_longer
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import by_record
from hybridid.trace.noise_floor import input_noise as module
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.noise_floor.input_noise import noisy_inputs
from hybridid.trace.refits.declared_starts import declared_starts
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.results.result import Trace
from hybridid.trace.run import trace
from hybridid.trace.search import longer
from hybridid.trace.verdict import conclude

NOISY = 3.0  # N
TRIED = (effect_named("quadratic_drag"),)
ALONE = {"variables": ("velocity",), "pairs": 0, "laws": False}


def measured(split, level, seed=0):
    """``split`` with white noise of ``level`` N in the force, as its sensor records it."""
    noise = np.random.default_rng(seed)
    return replace(
        split,
        records=tuple(
            replace(one, inputs=one.inputs + level * noise.standard_normal(one.inputs.shape))
            for one in split.records
        ),
    )


@pytest.fixture(scope="module")
def complete(split_of):
    return measured(split_of(), NOISY)


def test_a_complete_model_is_not_said_to_lack_something(make_model, complete):
    found = conclude(make_model(), Context(complete, TRIED, **ALONE))
    assert (found.verdict, found.accepted) == ("undecided", ())
    assert found.times > 3.0, "the noise of the encoder alone does not explain what is left"
    assert found.noisy.levels["force"].value == pytest.approx(NOISY, rel=0.3)
    (left,) = found.search.final.score.rmse
    assert left / 2 < found.noisy.leaves["position"].value <= left


def test_no_more_noise_is_told_than_may_leave_what_is_left(make_model, split_of, monkeypatch):
    """A command of a loop is rough: it looks noisier than any sensor."""
    split = measured(split_of(), 1.0)
    monkeypatch.setattr(module, "input_noise", lambda record: np.array([6.0]))
    context = Context(split, TRIED, **ALONE)
    final = refit(make_model(), split, factors=CONTINUATION)
    found = noisy_inputs(final, Accuracy.of(final, context), context)
    (left,) = final.score.rmse
    assert found.leaves["position"].value == pytest.approx(left)
    assert found.levels["force"].value < 3.0


@pytest.mark.parametrize(("level", "df_v"), [(0.0, 80.0), (0.05, 80.0)])
def test_what_the_noise_cannot_make_is_missing(make_model, split_of, level, df_v):
    """A force that is known exactly, and one whose noise leaves less than what is missing."""
    found = conclude(make_model(), Context(measured(split_of(df_v=df_v), level), TRIED, **ALONE))
    assert found.verdict == "unexplained"
    assert found.noisy is None


def test_the_sentence_says_how_much_noise_and_what_if_there_is_none(make_model, complete):
    first, second = complete.records
    said = trace(make_model(), [first], [second], horizon=0.25, effects=TRIED, **ALONE).sentence
    assert said.startswith("These records do not decide whether something is missing: the one effect tried")
    assert "The records show white noise of at most " in said
    assert "If force is known exactly, as a command is, something is missing." in said


def test_beside_an_effect_that_was_found_no_more_need_be_missing(make_model, split_of):
    first, second = measured(split_of(df_v=80.0), NOISY).records
    tried = [effect_named("asymmetric_viscous")]
    found = trace(make_model(), [first], [second], horizon=0.25, effects=tried, **ALONE)
    assert [one.effect for one in found.accepted] == ["asymmetric_viscous"]
    assert "but no more need be missing. The records show white noise of at most" in found.sentence
    assert "More is missing" not in found.sentence


def test_where_little_is_left_it_is_told_beside_that(make_model, split_of):
    """Between the noise of the encoder and three times that, nothing is called missing."""
    first, second = measured(split_of(), 1.0).records
    found = trace(make_model(), [first], [second], horizon=0.25, effects=TRIED, **ALONE)
    assert 1.05 < found.times < 3.0
    assert found.noisy is not None
    Draft202012Validator(schema(Trace)).validate(json.loads(json.dumps(plain(found))))
    assert "simulation alone leave. The records show white noise of at most" in found.sentence
    assert "If force is known exactly" not in found.sentence


@pytest.mark.parametrize(("noisy", "lengthens"), [(None, 1), (object(), 0)])
def test_noise_of_an_input_that_adds_up_over_longer_horizons_lengthens_none(monkeypatch, noisy, lengthens):
    """Over longer horizons a complete model of a carriage whose force is measured leaves far more."""
    found = SimpleNamespace(longer=SimpleNamespace(judged=True), noisy=noisy, accepted=())
    lengthened = []
    monkeypatch.setattr(over_longer, "declared_starts", lambda *_: [])
    monkeypatch.setattr(over_longer, "numerics_for", lambda *_: None)
    monkeypatch.setattr(over_longer, "over_long_enough", lambda model, context, *_: context)
    monkeypatch.setattr(over_longer, "conclude", lambda *_: found)
    monkeypatch.setattr(over_longer, "lengthened", lambda context, _: lengthened.append(context) or context)
    context = SimpleNamespace(split=None, out_of_time=False)
    assert over_longer.concluded(None, context, [], "auto", may_lengthen=True) == (found, context)
    assert len(lengthened) == lengthens


def test_a_search_does_not_begin_over_longer_horizons_that_show_such_noise_alone(
    make_model, two_records, monkeypatch
):
    """Over horizons of 0.125 s the noise of the force stays within that of the encoder, over 0.6 s not."""
    split = measured(by_record(*([one] for one in two_records(std=1e-5)), 25), 1.0)
    context, model = Context(split, TRIED, **ALONE), make_model()
    begun = (model, context, declared_starts(model, split, []), DECLARED)
    assert longer.over_long_enough(*begun).split.horizon == 25
    monkeypatch.setattr(longer, "made_by_noise", lambda *_: False)
    assert longer.over_long_enough(*begun).split.horizon == 125


def test_what_the_noise_of_an_input_cannot_make_is_sought_over_longer_horizons(make_model, two_records):
    split = by_record(*([one] for one in two_records(std=1e-5, df_v=4.0)), 25)
    context, model = Context(split, TRIED, **ALONE), make_model()
    starts = declared_starts(model, split, [])
    assert longer.over_long_enough(model, context, starts, DECLARED).split.horizon > 25
