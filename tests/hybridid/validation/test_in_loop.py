"""A model in the loop: what is compared, and when the law is not the one that ran the machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.controllers.controller import Controller
from hybridid.controllers.emps_pd import EMPSPD
from hybridid.controllers.loop import Loop
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.rigs.emps import EMPSRig
from hybridid.simulation.control_law import replayed
from hybridid.simulation.simulate import Diverged
from hybridid.validation import agreement, disagreement, in_loop, metrics, synchronised

GAINS = {"gain": 35.15}
TRUTH = {
    "M": 95.154,
    "carriage.viscous.f_v": 203.565,
    "carriage.coulomb.f_c": 20.386,
    "carriage.offset.offset": -0.242,
    "carriage.asymmetric_viscous.df_v": 73.718,
}


@pytest.fixture(scope="module")
def record():
    return EMPSRig().record("identification", duration=3.0)


@pytest.fixture(scope="module")
def model():
    return compose(EMPS(), ["viscous", "coulomb", "offset", "asymmetric_viscous"])


def test_outputs_and_effort_are_scored_and_labelled(record, model):
    prediction = in_loop(model, TRUTH, record, Loop(EMPSPD(), GAINS), 300)
    assert (prediction.view, prediction.provenance) == ("loop", "simulated")
    assert prediction.output_names == ("position", "force")
    assert prediction.output_units == ("m", "N")
    np.testing.assert_array_equal(prediction.measured, np.hstack([record.outputs, record.inputs]))
    position, force = metrics(prediction, "gray box")
    assert (position.output, force.output, force.unit, force.view) == ("position", "force", "N", "loop")
    assert position.rmse < 2e-6
    assert force.r2 > 0.999


def test_the_effort_shows_an_error_of_the_model_that_the_controller_hides(record, model):
    off = TRUTH | {"carriage.coulomb.f_c": 10.0}
    good, bad = (metrics(in_loop(model, v, record, Loop(EMPSPD(), GAINS), 300), "") for v in (TRUTH, off))
    assert bad[0].rmse < 2e-5  # of a stroke of 250 mm
    assert bad[1].rmse > 5 * good[1].rmse
    assert bad[1].rmse == pytest.approx(10.4, rel=0.2)


def test_the_law_that_ran_the_rig_agrees(record):
    (found,) = agreement(Loop(EMPSPD(), GAINS), record, 0.05)
    assert found.agrees
    assert found.share < 1e-6
    assert disagreement([found]) is None


@pytest.mark.parametrize("wrong", [{"kp": 120.0}, {"kv": 300.0}, {"gain": -35.15}])
def test_another_law_does_not(record, wrong):
    found = agreement(Loop(EMPSPD(), GAINS | wrong), record, 0.05)
    assert not found[0].agrees
    said = disagreement(found)
    assert said.startswith(
        "controller emps_pd is not the law that ran record emps_rig_identification: with the"
    )
    assert said.endswith("of the recorded one (controller.tolerance: 5 %)")
    assert "\n" not in said


def test_the_samples_at_which_a_slower_law_works_are_found(record):
    """A rig whose law works each fourth sample, begun with the third."""
    law = Loop(EMPSPD(), GAINS, every=4, phase=2)
    slower = replace(record, inputs=replayed(law, record))
    assert synchronised(Loop(EMPSPD(), GAINS, every=4), slower).phase == 2
    assert agreement(synchronised(Loop(EMPSPD(), GAINS, every=4), slower), slower, 0.05)[0].share < 1e-9


def test_states_that_nothing_shows_start_where_the_first_horizon_is_met_best(record):
    model = compose(EMPS(), ["viscous", "dahl"])
    values = {"M": 95.154, "carriage.viscous.f_v": 203.565}
    loop = Loop(EMPSPD(), GAINS)
    measured, estimated = (
        in_loop(model, values, record, loop, 300, start).initial_states[0]
        for start in ("measured", "estimated")
    )
    np.testing.assert_array_equal(measured[:2], estimated[:2])
    assert measured[2] == 0.0
    assert np.isfinite(estimated[2])


def test_a_loop_that_is_unstable_says_when(record, model):
    class Backwards(Controller):
        name, meaning, source = "backwards", "", ""
        references, outputs, commands = EMPSPD.references, EMPSPD.outputs, EMPSPD.commands
        parameters = EMPSPD.parameters

        def command(self, reference, outputs, state, p):
            return {"force": 1e9 * (outputs.position - reference.reference)}

    with pytest.raises(Diverged, match=r"record emps_rig_identification diverged in the loop at t = \d"):
        in_loop(model, TRUTH, record, Loop(Backwards()), 300)


def test_a_record_that_is_too_short_for_the_law_is_told(record):
    short = record.part(0, 12)
    with pytest.raises(ValueError, match="controller emps_pd must see 22 samples, record emps_rig_ident"):
        agreement(Loop(EMPSPD(), delay=20), short, 0.05)


def test_masked_samples_are_left_out(record, model):
    """The run through them is the same; one that is not simulated ends it."""
    whole = in_loop(model, TRUTH, record, Loop(EMPSPD(), GAINS), 300)
    levels = np.zeros(record.n, dtype=np.int8)
    levels[100:150] = 1
    masked = record.with_masked(levels)
    found = in_loop(model, TRUTH, masked, Loop(EMPSPD(), GAINS), 300)
    np.testing.assert_array_equal(found.rows, np.flatnonzero(masked.counts))
    np.testing.assert_array_equal(found.time, record.time[masked.counts])
    np.testing.assert_allclose(found.predicted, whole.predicted[masked.counts], atol=1e-6)
    apart = in_loop(model, TRUTH, record.with_masked(2 * levels), Loop(EMPSPD(), GAINS), 300)
    assert len(apart.time) == 100


def test_a_hand_on_the_machine_is_no_other_law(record):
    """Where it is masked, the recorded command may be anything."""
    levels = np.zeros(record.n, dtype=np.int8)
    levels[200:300] = 1
    pushed = np.where(levels[:, None] > 0, record.inputs + 50.0, record.inputs)
    disturbed = replace(record, inputs=pushed, warnings=())
    (seen,) = agreement(Loop(EMPSPD(), GAINS), disturbed, 0.01)
    (masked,) = agreement(Loop(EMPSPD(), GAINS), disturbed.with_masked(levels), 0.01)
    assert not seen.agrees
    assert masked.agrees
    early = np.ones(record.n, dtype=np.int8)
    early[:10] = 0
    with pytest.raises(ValueError, match=r"the mask of record .* leaves nothing to compare"):
        agreement(Loop(EMPSPD(), GAINS, every=20), record.with_masked(early), 0.01)
