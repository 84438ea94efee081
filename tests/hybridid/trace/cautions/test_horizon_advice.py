"""Other horizons are advised where those in use bend the fit, or where a state is hidden."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.trace.cautions.horizon_advice import (
    determining_parts_advised,
    few_samples,
    other_horizons_advised,
    parts_of_all_advised,
    slower_dynamics,
)

NOISE = np.array([0.01])


def final(*hidden: str, left: float | None = None):
    """A last model; over shorter horizons its fit has other parameters and leaves the error ``left``."""
    score = SimpleNamespace(rmse=np.array([left]))
    shorter = None if left is None else SimpleNamespace(score=score)
    states = [SimpleNamespace(name="q", observed_by="position")]
    states += [SimpleNamespace(name=name, observed_by=None) for name in hidden]
    return SimpleNamespace(model=SimpleNamespace(plant=SimpleNamespace(states=states)), shorter=shorter)


def split(horizons: int, samples: int = 200, dt: float = 0.005):
    numbers = tuple(range(horizons))
    return SimpleNamespace(
        horizon=samples, records=[SimpleNamespace(dt=dt)], fitted=numbers, held_out=numbers
    )


@pytest.mark.parametrize(("slowest", "but"), [(0.14, ""), (1.2, ", but not of what acts as slowly as 1.2 s")])
def test_shorter_ones_where_the_fit_is_bent(monkeypatch, slowest, but):
    monkeypatch.setattr("hybridid.trace.cautions.horizon_advice._slowest", lambda *_: slowest)
    assert other_horizons_advised(final(left=0.03), split(20), NOISE) == (
        " Over horizons of 0.1 s the fit has other parameters: what is missing bends it over longer ones. "
        f"trace.horizon=0.1 may show more{but}."
    )
    assert other_horizons_advised(final(), split(20), NOISE) == ""


def test_no_shorter_ones_that_show_nothing():
    """The fit over these leaves the noise, which moves its parameters."""
    assert other_horizons_advised(final(left=0.012), split(20), NOISE) == ""


def test_longer_ones_where_no_output_shows_a_state():
    """Though the fit is bent: over shorter ones the hidden state hides more."""
    said = other_horizons_advised(final("h", left=0.03), split(21, 50, 4.0), NOISE)
    assert said == (
        " No output shows h: estimated anew for each horizon, it may stand for what is missing. Longer "
        "horizons may show more (trace.horizon, at most 1000)."
    )


@pytest.mark.parametrize("horizons", [4, 7])
def test_none_where_the_records_give_no_longer_ones(horizons):
    assert other_horizons_advised(final("h"), split(horizons), NOISE) == ""


def test_dynamics_that_a_horizon_does_not_show_are_told(make_model, carriage):
    """The carriage's own time constant is M / f_v, here 3 s."""
    model, record = make_model(), carriage.record(n=3000, dt=0.02)
    slow = {**{p.name: p.guess for p in model.parameters}, "M": 90.0, "carriage.viscous.f_v": 30.0}

    def said(seconds: float) -> str:
        horizons = SimpleNamespace(records=(record,), horizon=round(seconds / record.dt))
        return slower_dynamics(SimpleNamespace(model=model, values=slow), horizons)

    assert said(0.5).startswith(
        " Beware: the horizons of 0.5 s are shorter than the slowest dynamics that the records resolve (3 s)."
    )
    assert said(2.5) == ""


@pytest.mark.parametrize(("fitted", "judging", "advised"), [(23, 10, True), (10, 10, False), (15, 10, False)])
def test_parts_of_every_record_judge_where_few_horizons_do(fitted, judging, advised):
    numbers = tuple(range(fitted + judging))
    whole = SimpleNamespace(fitted=numbers[:fitted], held_out=numbers[fitted:], gap=0)
    said = parts_of_all_advised(whole)
    assert bool(said) is advised
    if advised:
        assert said == (
            " Only 10 horizons judge. With trace.records=null trace.held_out=null parts of every record do, "
            "more or longer ones, which may decide more."
        )
    whole.gap = 3
    assert parts_of_all_advised(whole) == "", "parts of every record judge already"


def test_parts_of_every_record_may_determine_the_parameters():
    whole = SimpleNamespace(gap=0)
    assert determining_parts_advised(whole).startswith(
        " With trace.records=null trace.held_out=null parts of"
    )
    assert determining_parts_advised(SimpleNamespace(gap=3)) == ""


@pytest.mark.parametrize(("samples", "told"), [(3, True), (9, True), (10, False), (200, False)])
def test_horizons_of_few_samples_are_told(samples, told):
    """Of two states, of one output: two initial states from so many values."""
    own = SimpleNamespace(
        model=SimpleNamespace(outputs=("position",)),
        problem=lambda split: SimpleNamespace(moving=np.array([[True, True, False]])),
    )
    said = few_samples(own, split(20, samples))
    expected = f" Beware: each horizon estimates 2 initial states of its own from {samples} measured values."
    assert said.startswith(expected) is told
    assert bool(said) is told
