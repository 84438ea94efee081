"""What stands behind a verdict: names whose interval includes zero, and free decays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.declarations import Parameter
from hybridid.effects.library import effect_named
from hybridid.quantities import quantity
from hybridid.records.record import Channel, Record
from hybridid.trace.candidates import Candidate
from hybridid.trace.cautions import cautions
from hybridid.trace.cautions.cautions import (
    _confounded,
    _grows,
    _hidden_by_the_simulation,
    _more_over_longer,
    _moved,
    _no_longer_shown,
    _only_fitted,
    _other_held_out,
    _takes_little,
    marked_as_shown,
    not_told_from_zero,
)
from hybridid.trace.entries import AcceptedEffect, Floor, Value
from hybridid.trace.horizons.evidence import Comparison
from hybridid.trace.rules import Rules
from hybridid.trace.search.longer import Longer
from hybridid.trace.trials.trial import Trial


def test_what_grows_over_longer_horizons_is_told_beside_nothing():
    assert _grows(SimpleNamespace(grows=None), Rules()) == ""
    grown = [SimpleNamespace(grows=Longer(7.2, 1.43, judged=one), noisy=None) for one in (True, False)]
    judged, fitted = (_grows(one, Rules()) for one in grown)
    assert judged == (
        " Beware: over horizons of 7.2 s the model leaves 1.4 times what noise and simulation leave: an "
        "effect that adds up slowly may be missing."
    )
    assert fitted.startswith(" Beware: fitted over horizons of 7.2 s the model")
    grown[0].noisy = object()
    assert _grows(grown[0], Rules()) == "", "noise of the inputs does that"
    far = SimpleNamespace(grows=Longer(7.2, 3.1), noisy=None)
    assert _grows(far, Rules()) == "", "told of what was accepted in other words"


def test_what_only_the_fitted_horizons_show_is_told():
    """A delay, of which the horizons that judge hold a disturbance as well."""
    context = SimpleNamespace(rules=Rules())

    def after(fitted, held_out, ended_early=False, effect="input_delay", refused="", verdict="unexplained"):
        refit = SimpleNamespace(ended_early=ended_early, too_stiff=False)
        candidate = Candidate(effect_named(effect), "gas")
        delay = Trial(candidate, refit, Comparison(held_out, 1.0, 0.0), fitted)
        step = SimpleNamespace(trials=(delay,), taken=())
        found = SimpleNamespace(search=SimpleNamespace(steps=(step,)), refused=refused, verdict=verdict)
        return _only_fitted(found, context)

    assert after(0.72, -0.02) == (
        " gas.input_delay takes 72.0 % of the squared error from the fitted horizons; the others do not "
        "confirm it."
    )
    assert after(0.72, 0.3, verdict="undecided").endswith(
        "; of the others the RMSE falls by 30.0 %, not significantly."
    )
    assert after(0.72, 0.3, verdict="undecided", refused="30.0 % with gas.input_delay, refused") == "", (
        "told already"
    )
    assert after(0.4, -0.02) == after(0.72, 0.3) == after(0.72, -0.02, ended_early=True) == ""
    assert after(0.9, -0.02, effect="cogging") == "", "a sine of any pitch fits anything"
    assert _only_fitted(SimpleNamespace(search=SimpleNamespace(steps=())), context) == ""


def entry_of(effect: str, port: str, **values: tuple[float, float]):
    """What a search accepted, and its entry in the trace, with the parameters ``values``."""
    candidate = Candidate(effect_named(effect), port)
    accepted = SimpleNamespace(name=candidate.name, trial=SimpleNamespace(candidate=candidate))
    parameters = {name: Value(value, std, "1") for name, (value, std) in values.items()}
    entry = AcceptedEffect(
        effect=effect, port=port, title="", equation="", pattern="", source="", parameters=parameters,
        known={}, alike=(effect,), class_members=(), separating_experiments=(), p_value=1e-6, gain=0.5,
        at_step={}, likelihood_gain=1.0, step=1, survivals=(),
    )  # fmt: skip
    return accepted, entry


def traced_of(*pairs, correlation=0.0):
    """A trace of the effects that ``entry_of`` gives, its last fit with one ``correlation`` of all."""
    parameters = [
        SimpleNamespace(name=f"{accepted.name}.{name}", value=one.value, std=one.std)
        for accepted, entry in pairs
        for name, one in entry.parameters.items()
    ]
    correlations = np.full((len(parameters), len(parameters)), correlation)
    np.fill_diagonal(correlations, 1.0)
    terms = [SimpleNamespace(name=one.name, effect=one.trial.candidate.effect) for one, _ in pairs]
    model = SimpleNamespace(terms=terms, names_of=lambda name: (name,))
    estimate = SimpleNamespace(parameters=parameters, correlation=correlations)
    return Marked(tuple(entry for _, entry in pairs), model, estimate)


@dataclass(frozen=True)
class Marked:
    accepted: tuple
    model: SimpleNamespace
    estimate: SimpleNamespace


def told(effect: str, port: str, correlation=0.0, **values: tuple[float, float]) -> str:
    pair = entry_of(effect, port, **values)
    return not_told_from_zero([pair[0]], traced_of(pair, correlation=correlation))


def test_what_the_records_hardly_show_is_no_name_beside_one_that_they_show():
    sure, unsure = (
        entry_of(name, "arm", f_v=(1.3, std)) for name, std in (("viscous", 0.1), ("viscous", 1.0))
    )
    sure = (replace_name(sure[0], "arm.other"), sure[1])

    def shown(*pairs):
        return [one.shown for one in marked_as_shown([one for one, _ in pairs], traced_of(*pairs)).accepted]

    assert shown(sure, unsure) == [True, False]
    assert shown(unsure) == [True], "then all are named, with a caution"
    accepted, entry = unsure
    assert shown(sure, (accepted, replace(entry, alike=("viscous", "eddy_brake")))) == [True, True]
    assert shown(sure, (accepted, replace(entry, is_law=True))) == [True, True]
    marked = marked_as_shown([sure[0], accepted], traced_of(sure, unsure))
    assert not_told_from_zero([sure[0], accepted], marked) == "", "the sentence says so itself"


def replace_name(accepted, name):
    return SimpleNamespace(name=name, trial=accepted.trial)


def test_a_lag_of_a_second_that_is_known_to_four_is_doubted():
    assert told("sensor_lag", "angle", T=(1.3, 2.3)) == (
        " Beware: beside all others these records hardly show angle.sensor_lag: its interval includes zero."
    )
    assert told("sensor_lag", "angle", T=(1.3, 0.3)) == ""


@pytest.mark.parametrize(("second", "silent"), [((0.01, 0.1), False), ((0.5, 0.1), True)])
def test_of_two_amplitudes_one_is_enough(second, silent):
    said = told("cogging", "joint", A_s=(0.1, 0.2), A_c=second, pitch=(0.1, 0.001))
    assert (said == "") is silent


@pytest.mark.parametrize(("correlation", "silent"), [(-0.95, True), (0.0, False)])
def test_two_amplitudes_that_are_collinear_are_told_from_zero_together(correlation, silent):
    """Each is 1.5 standard errors from zero; their sum is 9."""
    said = told("varying_force_factor", "drive", correlation, b_1=(0.15, 0.1), b_2=(0.15, 0.1))
    assert (said == "") is silent


def test_a_limit_that_is_hard_is_not_doubted():
    stop = effect_named("end_stop")
    hard = {p.name: (1.0, 10.0) for p in stop.parameters if not p.fixed}
    assert told("end_stop", "joint", **hard) == ""


def left(squares):
    """A model that leaves these squared errors, one for each output."""
    return SimpleNamespace(score=SimpleNamespace(rmse=np.sqrt(np.array(squares, float))))


def found(takes=((99.5,), (0.5,)), mass=(2.0, 1.9), dropped=()):
    """A search that accepted two effects, which took so much of a squared error of 100 of each output, and
    moved a mass; the last one has made those ``dropped`` needless."""
    beside = [left(100.0 - np.sum(takes[:k], axis=0)) for k in range(3)]
    names = ["cart.coulomb", "cart.detent"]
    accepted = [
        SimpleNamespace(name=name, trial=SimpleNamespace(refit=refit, gain=0.25), together="")
        for name, refit in zip(names, beside[1:], strict=True)
    ]
    plant = SimpleNamespace(parameters=(Parameter("M", "kg", 1.0, upper=9.0),))
    first, final = (
        SimpleNamespace(
            values={"M": value}, std={"M": 0.1}, model=SimpleNamespace(plant=plant), score=model.score
        )
        for value, model in zip(mass, beside[::2], strict=True)
    )
    steps = [
        SimpleNamespace(dropped=gone, taken=(one,), base=base)
        for gone, one, base in zip(((), dropped), accepted, beside[:2], strict=True)
    ]
    return SimpleNamespace(first=first, final=final, accepted=accepted, steps=steps)


def test_what_takes_less_than_a_hundredth_may_mend_what_came_before():
    assert _takes_little(found()) == (
        " Beware: cart.detent takes 25.0 % off the error that its step began with, and 0.5 % of the squared "
        "error that all take. If the law of what was found before it is off by a tenth, that alone leaves as "
        "much."
    )
    assert _takes_little(found(takes=((98.0,), (2.0,)))) == ""
    assert _takes_little(found(takes=((0.5,), (99.5,)))) == "", "what came first mends nothing"
    assert _takes_little(found(dropped=("cart.stribeck",))) == "", "it takes what the stribeck took, too"


def test_what_takes_much_of_one_output_mends_nothing():
    assert _takes_little(found(takes=((99.9, 60.0), (0.1, 40.0)))) == ""
    assert "0.4 % of the squared error" in _takes_little(found(takes=((99.9, 99.6), (0.1, 0.4))))


def test_a_form_that_the_last_model_does_not_show_is_doubted(monkeypatch):
    """A contact that a later effect has moved to where the machine always presses it."""
    reasons = {"cart.end_stop": "it acts in every fitted sample", "cart.coulomb": ""}
    accepted = [SimpleNamespace(name=name, trial=SimpleNamespace(candidate=name)) for name in reasons]
    monkeypatch.setattr(cautions, "not_shown", lambda candidate, final, split: reasons[candidate])
    assert _no_longer_shown(SimpleNamespace(accepted=accepted, final=None), SimpleNamespace(split=None)) == (
        " Beware: the last model no longer shows the form of cart.end_stop (it acts in every fitted sample)."
    )


@pytest.mark.parametrize("mass", [(2.0, 0.9), (2.0, 4.1), (2.0, -1.0)])
def test_a_mass_that_is_halved_is_told(mass):
    assert _moved(found(mass=mass)) == (
        f" With what was accepted M moves from 2 kg to {quantity(mass[1], 'kg', 3)}: compare that with what "
        "you know of the machine."
    )
    assert _moved(found()) == ""


def test_a_mass_that_moves_to_its_bound_is_told_with_it():
    assert "M moves from 2 kg to 9 kg, its bound: compare" in _moved(found(mass=(2.0, 9.0)))


def test_a_mass_that_moves_within_its_error_is_not_told():
    assert _moved(found(mass=(0.15, -0.04))) == ""


def test_a_mass_that_was_not_determined_has_not_moved():
    before = found(mass=(2.0, 19.0))
    before.first.std["M"] = 14.0
    assert _moved(before) == ""


@pytest.mark.parametrize(
    ("times", "longer", "told"), [(1.0, 15.5, True), (1.0, None, False), (9.0, 15.5, False)]
)
def test_what_is_named_at_the_noise_is_doubted_where_longer_horizons_leave_more(
    monkeypatch, times, longer, told
):
    seen = longer and Longer(4.0, longer)
    monkeypatch.setattr(cautions, "more_over_longer", lambda final, context: seen)
    named = SimpleNamespace(times=times, search=SimpleNamespace(final=None), grows=None)
    said = _more_over_longer(named, SimpleNamespace(rules=Rules(), out_of_time=False))
    assert bool(said) is told
    if told:
        assert "over horizons of 4 s the last model leaves 15.5 times what noise" in said
        assert said.endswith("trace.horizon=4 asks there.")


@pytest.fixture
def make_decay():
    """A free swing from ``amplitude`` rad, simulated: 10 s at 100 Hz."""

    def make(amplitude=1.0):
        t = np.arange(0, 10, 0.01)
        return Record(
            name="decay",
            time=t,
            inputs=np.empty((len(t), 0)),
            outputs=(amplitude * np.exp(-0.2 * t) * np.cos(12 * t))[:, None],
            input_channels=(),
            output_channels=(Channel("angle", "rad"),),
            simulated=True,
        )

    return make


def test_a_free_decay_warns_beside_a_name(make_decay):
    """Amplitude and time are one there, so a friction over the one may be a friction over the other."""
    assert _confounded([make_decay()]).startswith(
        " Beware: amplitude and time cannot be told apart in decay: a free decay"
    )
    assert _confounded([make_decay(), make_decay(amplitude=0.3)]) == ""


def accepted_twice(here, there):
    both = {"parameters": {"T": Value(*here, "s")}, "by_held_out": {"T": Value(*there, "s")}}
    return [SimpleNamespace(name="temperature.sensor_lag", **both)]


def test_a_parameter_that_is_another_one_held_out_is_told():
    assert _other_held_out(accepted_twice((27.0, 0.7), (15.9, 0.7)), Rules()) == (
        " Beware: T of temperature.sensor_lag is 27.0 ± 1.4 s in the fitted records, 15.9 ± 1.4 s in those "
        "held out: the form may be another one, or the machine has changed."
    )


@pytest.mark.parametrize("there", [(25.0, 0.1), (15.9, 7.0), (15.9, float("nan"))])
def test_a_parameter_that_differs_little_or_by_chance_is_not(there):
    assert _other_held_out(accepted_twice((27.0, 0.1), there), Rules()) == ""


@pytest.mark.parametrize(
    ("simulation", "smooths", "said"), [(14e-6, True, True), (14e-6, False, False), (4e-7, True, False)]
)
def test_what_the_error_of_the_simulation_hides_is_told(simulation, smooths, said):
    floor = {"position": Floor(2.4e-7, "m", simulation)}
    traced = SimpleNamespace(noise_floor=floor, rules=Rules())
    told = _hidden_by_the_simulation(traced, SimpleNamespace(smooths=smooths))
    assert told.startswith(" Beware: the simulation errs by 14 µm of position, far more") is said
    assert (told == "") is not said
