"""Delays and lags of a slow process: found at its sampling, begun at rest, no free initial values."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.effects.library import effect_named
from hybridid.effects.sampled import sampled
from hybridid.model import compose
from hybridid.plants.plant import Plant
from hybridid.records.record import Channel, Record
from hybridid.simulation import simulate
from hybridid.simulation.initial import measured_states
from hybridid.trace.candidates import Candidate, admissible
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.refits.refit import refit
from hybridid.trace.run import trace
from hybridid.trace.trials.trial import _with_form_fitted, attempt

DT, LATE, TAU = 0.08, 3, 0.5  # s, samples, s
AT_REST = 5.0  # V before the record


@dataclass(frozen=True)
class Oven(Plant):
    """``tau T' = gain u - T``: a heater that is on before the record begins."""

    direct: bool = False

    name, meaning, source = "oven", "an oven", "the tests"
    states = (State("T", "V", scale=5.0, observed_by="T", derivative=0),)
    inputs = (Signal("u", "V"),)
    outputs = (Signal("T", "V"),)
    parameters = (
        Parameter("tau", "s", guess=0.4, lower=0.01, upper=10.0),
        Parameter("gain", "1", guess=0.8, lower=0.0, upper=10.0),
    )
    ports = (Port("u", "input", "V", 5.0), Port("T", "output", "V", 5.0))

    def motion(self, x, u, p):
        return {}

    def derivative(self, x, u, p, effort):
        return {"T": (p.gain * u.u - x.T) / p.tau}

    def output(self, x, u, p):
        return {"T": x.T + (0.01 * u.u if self.direct else 0.0)}


def recorded(seed: int, late: int = LATE, n: int = 600, before: float = AT_REST) -> Record:
    """The exact step response of the oven, ``late`` samples behind a switching input, with noise. It is at
    rest ``before`` [V] the record."""
    generator = np.random.default_rng(seed)
    switching = AT_REST + np.repeat(generator.choice([-1.5, 1.5], n // 5), 5)
    switching[:5] = AT_REST
    delayed = np.concatenate([np.full(late, before), switching[: n - late]])
    level, keeps = np.full(n, before), np.exp(-DT / TAU)
    for k in range(n - 1):
        level[k + 1] = keeps * level[k] + (1 - keeps) * delayed[k]
    noisy = level + 0.01 * generator.normal(size=n)
    return Record(
        f"run {seed}",
        DT * np.arange(n),
        switching[:, None],
        noisy[:, None],
        (Channel("u", "V", "zoh"),),
        (Channel("T", "V"),),
        simulated=True,
    )


def test_a_delay_of_some_samples_is_found_however_long_they_last():
    found = trace(
        compose(Oven(), []),
        [recorded(1)],
        [recorded(2)],
        horizon=2.4,
        effects=["input_delay", "sensor_lag", "sensor_offset"],
        laws=False,
        pairs=0,
    )
    (entry,) = found.accepted
    assert entry.effect == "input_delay"
    assert entry.parameters["delay"].value == pytest.approx(LATE * DT, rel=0.03)
    assert found.estimates.after["tau"].value == pytest.approx(TAU, rel=0.03)


@pytest.mark.parametrize(("before", "settled"), [(AT_REST, 1.0), (0.0, 0.0)])
def test_the_records_tell_a_settled_heater_from_one_that_was_switched_on_with_them(before, settled):
    split = by_record([recorded(1, before=before)], [recorded(2, before=before)], 30)
    (delay,) = sampled([effect_named("input_delay")], DT)
    base = refit(compose(Oven(), []), split)
    found = attempt(Candidate(delay, "u"), base, split)
    assert found.own("values")["settled"] == settled
    assert found.own("values")["delay"] == pytest.approx(LATE * DT, rel=0.03)
    assert found.refit.score.rmse < 0.03, "noise, and what the approximant makes of steps"
    asked = replace(base, model=replace(base.model, adjustments={"u.input_delay.settled": {"fixed": 1.0}}))
    kept = attempt(Candidate(delay, "u"), asked, split)
    assert kept.own("values")["settled"] == 1.0
    assert (kept.refit.cost > 1.5 * found.refit.cost) is (settled == 0.0)


def test_the_last_model_keeps_that_the_heater_was_switched_on_with_the_record():
    """Its free runs begin with the records, and leave no more than horizons do."""
    found = trace(
        compose(Oven(), []),
        [recorded(1, before=0.0)],
        [recorded(2, before=0.0)],
        horizon=2.4,
        effects=["input_delay"],
        laws=False,
        pairs=0,
    )
    assert found.accepted[0].known["settled"].value == 0.0
    assert [row.rmse for row in found.after] == pytest.approx([0.0277] * len(found.after), rel=0.02)


@pytest.mark.parametrize("effect", ["input_lag", "input_delay", "sensor_lag"])
def test_a_path_is_at_rest_before_the_record(effect):
    """A constant input: a path that began at zero would make a step of it."""
    still = recorded(1, late=0)
    still = Record(
        "still",
        still.time,
        np.full_like(still.inputs, AT_REST),
        still.outputs,
        still.input_channels,
        still.output_channels,
        simulated=True,
    )
    model = compose(Oven(), [effect])
    late = next(p.name for p in effect_named(effect).parameters if p.nests)
    term = model.terms[0].name
    known = {"tau": TAU, "gain": 1.0, f"{term}.{late}": 5e-3}
    begun = np.append([AT_REST], measured_states(model, still)[0][1:])
    run = simulate(model, known, still, begun, integrator="rodas3")
    assert run.outputs == pytest.approx(AT_REST, abs=1e-9)


def test_a_sensors_lag_has_no_free_initial_value():
    """The lagged signal would be one more free value a horizon: it took what is no lag."""
    split = by_record([recorded(1)], [recorded(2)], 30)
    problem = DECLARED.problem(compose(Oven(), ["sensor_lag"]), split, 1)
    assert problem.moving.sum(axis=1).tolist() == [1] * problem.windows.count


def test_the_rate_of_an_output_that_jumps_with_the_input_is_unknown():
    lag = effect_named("sensor_lag")
    assert [one.name for one in admissible(compose(Oven(), []), [lag])] == ["T.sensor_lag"]
    assert not list(admissible(compose(Oven(direct=True), []), [lag]))
    with pytest.raises(ValueError, match="output T depends on an input at once"):
        _ = compose(Oven(direct=True), ["sensor_lag"]).f


def test_a_window_that_would_be_too_stiff_is_not_taken():
    """The trial that was found stays: it must not be lost for the sake of a better window."""
    split, delay = by_record([recorded(1)], [recorded(2)], 30), Candidate(effect_named("input_delay"), "u")
    base = refit(compose(Oven(), []), split)
    (start,) = delay.starts(delay.added_to(base.model), base.values)[:1]
    found = replace(base, model=delay.added_to(base.model), values={**start, f"{delay.name}.delay": 1e-9})
    assert _with_form_fitted(found, delay, split) is found
