"""A smoothing of sign(v) that leaves an error is made narrower before anything is named."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.learned.minor import MINOR
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.refits.refit import refit
from hybridid.trace.search import search as search_module
from hybridid.trace.search import sharper
from hybridid.trace.search.search import search
from hybridid.trace.search.sharper import narrowed, sharp_enough, sharper_for_an_effect
from hybridid.trace.search.steps import Accepted, Step
from hybridid.trace.trials.trial import attempt


@pytest.fixture(scope="module")
def split(split_of):
    return split_of()


def smoothed(model, **setting):
    return replace(model, adjustments={**model.adjustments, "carriage.epsilon": setting})


def width_of(model):
    return next(p.guess for p in model.parameters if p.name == "carriage.epsilon")


def test_too_wide_a_smoothing_is_halved_until_that_gains_nothing(make_model, split):
    """The truth creeps as tanh(v/epsilon) does, epsilon that of the port."""
    model = make_model()
    true = width_of(model)
    wide = refit(smoothed(model, guess=8 * true), split)
    said = []
    found = sharp_enough(wide, Context(split, say=said.append))
    assert true <= width_of(found.model) <= 2 * true
    assert found.score.loss < 0.7 * wide.score.loss
    assert found.std
    assert len(said) == pytest.approx(3, abs=1)
    (told,) = narrowed(wide.model, found.model)
    assert (told.name, told.declared, told.used) == ("carriage.epsilon", 8 * true, width_of(found.model))


def test_a_smoothing_that_leaves_nothing_stays(make_model, split):
    base = refit(make_model(), split)
    assert sharp_enough(base, Context(split)) is base
    assert narrowed(base.model, base.model) == ()


def test_a_width_between_two_halves_is_found(make_model, split):
    """Half of it is too narrow, and no gauge with another range must stand for the rest."""
    true = width_of(make_model())
    wide = refit(smoothed(make_model(), guess=1.5 * true), split)
    said = []
    found = sharp_enough(wide, Context(split, say=said.append))
    assert width_of(found.model) == pytest.approx(true, rel=0.02)
    assert next(p for p in found.model.parameters if p.name == "carriage.epsilon").fixed
    assert found.score.loss < 0.9 * wide.score.loss
    assert len(said) == 2, "half, then between"


@pytest.mark.parametrize(("times", "most"), [(0.9, 1.0), (0.3, 0.6), (4.0, 4.0)])
def test_no_width_becomes_wider_than_that_of_the_port(make_model, split, monkeypatch, times, most):
    """Where a machine creeps more than its port says, that is an effect to be found."""
    model = make_model(("coulomb",))
    (port,) = [port.epsilon for port in model.plant.ports if port.name == "carriage"]
    base = refit(smoothed(model, guess=times * port), split)
    asked = []

    def bounds(model, *given):
        asked.append(model.adjustments["carriage.epsilon"])

    monkeypatch.setattr(sharper, "refit_if_possible", bounds)
    assert sharp_enough(base, Context(split)) is base
    expected = {"lower": times * port / 2, "guess": times * port, "upper": most * port}
    assert asked[-1] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("errors", "kept"),
    [((1.1, 0.5, 0.49, 0.48), 1), ((1.1, 1.2, 0.1, 0.1), None), ((0.5, 0.6, 0.2, 0.195), 2)],
)
def test_a_quarter_is_looked_at_where_a_half_does_not_pay(make_model, split, monkeypatch, errors, kept):
    base = refit(make_model(), split)
    squares = [replace(base.score, squares=error**2 * base.score.squares) for error in errors]
    halves = [replace(base, score=score) for score in squares]
    coming = iter(halves)
    monkeypatch.setattr(sharper, "_halved", lambda last, context: next(coming))
    found = sharp_enough(base, Context(split))
    assert found is (base if kept is None else halves[kept])


def test_an_epsilon_that_the_user_fixed_stays(make_model, split):
    model = make_model()
    fixed = refit(smoothed(model, fixed=8 * width_of(model)), split)
    assert sharp_enough(fixed, Context(split)) is fixed


@pytest.fixture
def too_wide(make_model):
    """A smoothing that leaves an error, which is a small part of the whole while the asymmetry is missing."""
    return smoothed(make_model(), guess=4 * width_of(make_model()))


TRIED = tuple(map(effect_named, ("asymmetric_viscous", "quadratic_drag")))


def test_a_smoothing_that_pays_only_beside_an_effect_leaves_it_if_it_stays_the_best(too_wide, split_of):
    said = []
    found = search(
        too_wide, Context(split_of(df_v=75.0), TRIED, say=said.append, variables=("velocity",)), [{}]
    )
    assert [one.name for one in found.accepted] == ["carriage.asymmetric_viscous"]
    assert width_of(found.final.model) < width_of(found.first.model)
    assert not any("begins anew" in line for line in said)


def test_where_another_effect_then_explains_more_the_search_begins_anew(too_wide, split_of, monkeypatch):
    said = []
    monkeypatch.setattr(search_module, "_outdone", lambda sharp, steps, context: "b than a" if steps else "")
    found = search(
        too_wide, Context(split_of(df_v=75.0), TRIED, say=said.append, variables=("velocity",)), [{}]
    )
    assert [one.name for one in found.accepted] == ["carriage.asymmetric_viscous"]
    assert sum("begins anew" in line for line in said) == 1
    assert width_of(found.final.model) == width_of(found.first.model) < width_of(too_wide)


def test_the_search_begins_anew_only_if_time_is_left_for_as_much_again(too_wide, split_of, monkeypatch):
    said = []
    monkeypatch.setattr(search_module, "_outdone", lambda sharp, steps, context: "b than a" if steps else "")
    monkeypatch.setattr(Context, "has_time_for", lambda self, seconds: seconds < 1e-6)
    found = search(
        too_wide, Context(split_of(df_v=75.0), TRIED, say=said.append, variables=("velocity",)), [{}]
    )
    assert [one.name for one in found.accepted] == ["carriage.asymmetric_viscous"]
    assert not any("begins anew" in line for line in said)


def test_a_step_is_made_again_with_a_narrower_smoothing_once(make_model, split_of, monkeypatch):
    """As if the effect passed each time that it is retried, and never in the step: the wider one stays."""
    context = Context(split_of(df_v=75.0), TRIED[1:], variables=("velocity",))
    made = []

    def narrower(step, context):
        made.append(step)
        return replace(step.base, status="narrower")

    monkeypatch.setattr(search_module, "sharper_for_an_effect", narrower)
    found = search(make_model(), context, [{}])
    assert found.accepted == ()
    assert len(made) == 1
    assert found.steps == (made[0],)
    assert found.final is made[0].base


def test_an_effect_that_explains_more_in_the_place_of_another_outdoes_it(make_model, split_of):
    context = Context(split_of(df_v=75.0))
    base = refit(make_model(), context.split)
    poor, good = (
        attempt(Candidate(effect_named(name), "carriage"), base, context.split)
        for name in ("asymmetric_coulomb", "asymmetric_viscous")
    )
    step = Step(base, (poor, good), Accepted(poor, (poor,), ()))
    assert search_module._outdone(poor.refit, [step], context).endswith(f" than {poor.candidate.name}")
    assert not search_module._outdone(good.refit, [step], context), "what was taken out has no place"
    assert not search_module._outdone(poor.refit, [replace(step, trials=(poor,))], context)
    assert not search_module._outdone(
        good.refit, [replace(step, accepted=Accepted(good, (good,), ()))], context
    )


def test_where_none_passes_the_best_are_tried_with_a_narrower_smoothing(make_model, split_of):
    """As if the asymmetry had been refused, for an error of the smoothing."""
    said = []
    context = Context(split_of(df_v=75.0), TRIED, say=said.append, variables=("velocity",))
    base = refit(make_model(), context.split)
    candidates = [Candidate(effect, "carriage") for effect in TRIED]
    trials = tuple(attempt(one, base, context.split) for one in candidates)
    step = Step(base, trials, None)
    sharp = sharper_for_an_effect(step, context)
    assert width_of(sharp.model) == width_of(base.model) / 2
    assert said[-1].endswith("from here on: then carriage.asymmetric_viscous passes")
    assert sharper_for_an_effect(replace(step, trials=()), context) is None
    fixed = replace(base, model=smoothed(base.model, fixed=width_of(base.model)))
    assert sharper_for_an_effect(replace(step, base=fixed), context) is None
    minor = tuple(replace(one, reason=f"{MINOR}most is something else") for one in trials)
    assert sharper_for_an_effect(replace(step, trials=minor), context) is None, "it passed before"


FALLING = {
    "M": 95.0, "carriage.viscous.f_v": 200.0, "carriage.coulomb.f_c": 20.0, "carriage.offset.offset": -3.0,
    "carriage.stribeck.df_s": 8.0, "carriage.stribeck.v_s": 0.02,
}  # fmt: skip


def test_a_half_that_paid_only_without_the_effect_is_taken_back(make_model, split_by_model):
    """A machine that creeps as its model says, with friction that falls with the speed: beside a model that
    lacks this, half of epsilon leaves less."""
    creeping = split_by_model(make_model(("viscous", "coulomb", "offset", "stribeck")), FALLING)
    said, tried = [], tuple(map(effect_named, ("stribeck", "quadratic_drag")))
    context = Context(creeping, tried, say=said.append, laws=False)
    found = search(make_model(), context, [{}], DECLARED)
    assert "from here on" in said[0]
    assert [one.name for one in found.accepted] == ["carriage.stribeck"]
    assert found.accepted[0].trial.own("values")["df_s"] == pytest.approx(8.0, rel=0.01)
    assert width_of(found.final.model) == pytest.approx(width_of(make_model()), rel=0.01)


def test_a_half_that_pays_beside_the_effect_too_stays(make_model, split_of):
    split, model = split_of(df_v=80.0), make_model()
    wide = refit(smoothed(model, guess=4 * width_of(model)), split)
    base = refit(model, split)
    effects = [Candidate(effect_named("asymmetric_viscous"), "carriage")]
    step = Step(base, tuple(attempt(one, base, split) for one in effects), None)
    assert not sharper.explains_more_wider(step, wider=wide, context=Context(split))
    assert not sharper.explains_more_wider(replace(step, trials=()), wide, Context(split))


@pytest.fixture
def in_many_steps(make_model, split, monkeypatch):
    """A model with eight times the epsilon of the machine, in 60 steps a sample, of which each half takes
    twice as many: more than is given to a trial."""

    def chain(terms):
        model = make_model(terms)
        fitted = {}
        for times in (8, 4, 2, 1):
            one = refit(smoothed(model, guess=times * width_of(model)), split)
            fitted[times] = replace(one, substeps=480 // times)

        def halved(one, context):
            times = round(width_of(one.model) / width_of(model))
            half = fitted.get(times // 2)
            return half if half and half.substeps <= 1.5 * one.substeps else None

        monkeypatch.setattr(sharper, "_halved", halved)
        return fitted

    return chain


def test_a_model_that_needs_more_steps_than_a_trial_is_made_sharp_by_itself(in_many_steps, split):
    fitted, said = in_many_steps(("viscous", "coulomb", "offset")), []
    assert sharp_enough(fitted[8], Context(split, say=said.append), declared=True) is fitted[1]
    assert len(said) == 1
    assert said[0].endswith("from here on: that leaves hardly more than the noise")


def test_halves_that_pay_for_one_output_lead_to_the_noise(in_many_steps, split, monkeypatch):
    """As if they did not pay for a trial of each effect, though none takes too many steps for one."""
    monkeypatch.setattr(sharper, "halved_while_it_pays", lambda base, *_: base)
    fitted = in_many_steps(("viscous", "coulomb", "offset"))
    for one in fitted.values():
        object.__setattr__(one, "substeps", one.substeps // 20)
    assert sharp_enough(fitted[8], Context(split), declared=True) is fitted[1]


def test_a_last_half_that_meets_the_noise_is_taken_though_it_pays_little(in_many_steps, split, monkeypatch):
    """As if the half before it left hardly more than the noise."""
    fitted = in_many_steps(("viscous", "coulomb", "offset"))
    context = Context(split)
    met = {id(fitted[k].score) for k in (2, 1)}
    monkeypatch.setattr(Context, "meets_noise", lambda self, score: id(score) in met)
    monkeypatch.setattr(Context, "noise_leaves_no_room", lambda self, score: False)
    monkeypatch.setattr(sharper, "compare", lambda *_: SimpleNamespace(gain=0.0, largest=0.01))
    assert sharp_enough(fitted[4], context, declared=True) is fitted[2]


def test_it_stays_as_it_is_where_trials_follow(in_many_steps, split, monkeypatch):
    monkeypatch.setattr(sharper, "_between_halves", lambda base, halved, context: base)
    fitted = in_many_steps(("viscous", "offset"))
    assert sharp_enough(fitted[8], Context(split), declared=True) is fitted[8], "it lacks an effect"
    monkeypatch.setattr(sharper, "MOST_BY_ITSELF", 240)
    fitted = in_many_steps(("viscous", "coulomb", "offset"))
    assert sharp_enough(fitted[8], Context(split), declared=True) is fitted[8], "that many take too long"
    monkeypatch.setattr(sharper, "MOST_BY_ITSELF", 480)
    assert sharp_enough(fitted[8], Context(split)) is fitted[8], "it holds effects, which are doubted"
