"""Steps a sample: as many as the equations at hand ask for, and a clear word when that is too many."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.records.record import Channel, Record
from hybridid.simulation import simulate
from hybridid.simulation.stability import (
    IMPLICIT,
    MOST,
    TooStiff,
    in_enough_steps,
    stays_near,
    substeps_for,
    substeps_to_predict,
)

SPRING = ("viscous", "linear_stiffness")


def values(model, stiffness: float, damping: float) -> np.ndarray:
    return model.values({"M": 1.0, "carriage.linear_stiffness.k": stiffness, "carriage.viscous.f_v": damping})


def test_a_stiffer_spring_asks_for_more_steps(carriage, make_model):
    model, made = make_model(SPRING), carriage.record(200)
    steps = [substeps_for(model, values(model, k, 2 * np.sqrt(k)), [made]) for k in (1e2, 1e5, 1e7)]
    assert steps[0] == 1
    assert steps[0] < steps[1] < steps[2]


def test_the_steps_it_chooses_are_stable(carriage, make_model):
    model, made = make_model(SPRING), carriage.record(400)
    known = {"M": 1.0, "carriage.linear_stiffness.k": 1e6, "carriage.viscous.f_v": 2e3}
    run = simulate(model, known, made)
    assert np.abs(run.outputs[100:, 0]).max() < 2 * 80 / 1e6, "force over stiffness"


def test_a_lightly_damped_resonance_is_integrated_accurately():
    """With zeta = 0.02 and seven samples a period the stability limit alone would damp it twice over."""
    from hybridid.model import compose
    from hybridid.plants.emps import EMPS

    n, dt, omega, zeta = 400, 0.01, 90.0, 0.02
    time = np.arange(n) * dt
    made = Record(
        "resonance",
        time,
        np.zeros((n, 1)),
        np.sin(time)[:, None],
        (Channel("force", "N"),),
        (Channel("position", "m"),),
    )
    model = compose(EMPS(), SPRING)
    known = {"M": 1.0, "carriage.linear_stiffness.k": omega**2, "carriage.viscous.f_v": 2 * zeta * omega}
    run = simulate(model, known, made, np.array([1.0, 0.0]))
    fast = omega * np.sqrt(1 - zeta**2)
    exact = np.exp(-zeta * omega * time) * (np.cos(fast * time) + zeta * omega / fast * np.sin(fast * time))
    assert np.sqrt(np.mean((run.outputs[:, 0] - exact) ** 2)) < 0.03 * exact.std()


def test_sharper_friction_asks_for_more_steps(carriage, make_model):
    made = carriage.record(200)
    steps = []
    for epsilon in (1e-2, 5e-4, 1e-4):
        model = make_model(adjust={"carriage.epsilon": {"fixed": epsilon}})
        steps.append(substeps_for(model, model.values(carriage.truth), [made]))
    assert steps[0] < steps[1] < steps[2], "even where no sample is at rest"


def test_too_stiff_a_model_is_refused_in_one_line(carriage, make_model):
    model = make_model(SPRING)
    with pytest.raises(ValueError, match=f"too stiff for RK4.*{MOST} steps") as caught:
        substeps_for(model, values(model, 1e12, 1.0), [carriage.record(200)])
    assert "\n" not in str(caught.value)


def test_an_implicit_method_needs_no_more_steps_for_stiffness(carriage, make_model):
    model, made = make_model(SPRING), carriage.record(200)
    p = values(model, 1e8, 2e6)
    assert substeps_for(model, p, [made], integrator="rodas3") <= 8


def test_a_kink_that_spoils_derivatives_alone_is_predicted(carriage, make_model):
    """50 steps a sample do not resolve this kink of a dry friction. The motion is the same
    as with one that they do resolve."""
    made, motions = carriage.record(400), []
    for epsilon in (2e-5, 2e-6):
        model = make_model(("viscous", "coulomb"), {"carriage.epsilon": {"fixed": epsilon}})
        known = {"M": 95.0, "carriage.viscous.f_v": 200.0, "carriage.coulomb.f_c": 20.0}
        motions.append(simulate(model, known, made, integrator=IMPLICIT).outputs)
    with pytest.raises(TooStiff, match="50 steps a sample do not resolve it"):
        substeps_for(model, model.values(known), [made], integrator=IMPLICIT)
    assert substeps_to_predict(model, model.values(known), [made], IMPLICIT) == MOST
    assert np.abs(motions[0] - motions[1]).max() < 1e-3 * motions[0].std()


def test_an_unknown_integrator_is_named(carriage, make_model):
    model = make_model()
    with pytest.raises(ValueError, match=r"unknown integrator 'rk5'.*rk4, rodas3"):
        substeps_for(model, model.values(), [carriage.record(100)], integrator="rk5")


@pytest.mark.parametrize("integrator", ["rk4", "rodas3"])
def test_a_fast_state_that_no_output_shows_is_asked_along_an_accurate_path(integrator):
    """A bristle that lets go within a tenth of a sample: one step a sample takes it far beyond its bound, and
    there the model looks too stiff for any integrator."""
    from hybridid.model import compose
    from hybridid.plants.duffing import Duffing

    n, dt = 4000, 1 / 610
    time = np.arange(n) * dt
    push = 0.1 * time / time[-1] * np.sin(2 * np.pi * 62 * time)
    inputs, outputs = (Channel("V1", "V"),), (Channel("V2", "V"),)
    bristle = "oscillator.cube_of_bristle_deflection"
    known = {"m": 5.37e-6, "d": 2.29e-4, "k": 0.99, f"{bristle}.k": -1.1e-4, f"{bristle}.d": 4.3e-3}
    model, rest = compose(Duffing(), ["cube_of_bristle_deflection"]), np.zeros(3)
    exact = simulate(
        model, known, Record("arrow", time, push[:, None], np.zeros((n, 1)), inputs, outputs), rest, 100
    )
    made = Record("arrow", time, push[:, None], exact.outputs, inputs, outputs)
    assert substeps_for(model, model.values(known), [made], integrator=integrator) <= MOST
    run = simulate(model, known, made, rest, integrator=integrator)
    assert np.sqrt(np.mean((run.outputs - exact.outputs) ** 2)) < 1e-3 * exact.outputs.std()


def test_what_diverges_is_simulated_in_twice_as_many_steps():
    def diverges_below_twelve(steps: int) -> int:
        return steps if steps >= 12 else 0

    assert in_enough_steps(diverges_below_twelve, bool, 3) == 24, "twelve are only just stable"
    assert in_enough_steps(diverges_below_twelve, bool, 15) == 15


def test_what_diverges_in_any_steps_ends():
    tried = []
    assert not in_enough_steps(lambda steps: tried.append(steps), lambda found: found is not None, 7)
    assert tried == [7, 14, 28]


def test_a_number_far_beyond_the_record_is_an_instability_of_few_steps(carriage):
    """Whether 1e75 comes out or infinity is a matter of the processor's rounding."""
    made = carriage.record(100)
    assert stays_near(1e3 * made.outputs, made)
    assert not stays_near(1e75 * made.outputs, made)
    assert not stays_near(np.full_like(made.outputs, np.nan), made)
    silent = replace(made, outputs=0 * made.outputs)
    assert stays_near(np.ones_like(made.outputs), silent), "beside zeros nothing is far"
