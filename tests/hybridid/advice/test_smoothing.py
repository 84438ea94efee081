"""Where the smoothing of sign(v) makes most of what a fit leaves, the epsilon that would do is told."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.advice.smoothing import wide_smoothing
from hybridid.estimators import FitSettings, fit
from hybridid.estimators.estimate import Left
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.quality import judge
from hybridid.rigs.emps import EMPSRig

WIDTH = SimpleNamespace(name="joint.epsilon", guess=0.08)


def advised(rmse, noise=0.1, simulation=0.0, step=0.0, widths=(0,)):
    left = Left("angle", "rad", rmse, noise, simulation, step, np.nan, False)
    problem = SimpleNamespace(model=SimpleNamespace(parameters=(WIDTH,)), widths=list(widths))
    return [one.said for one in wide_smoothing(problem, SimpleNamespace(left=(left,)))]


def test_epsilon_is_halved_until_it_leaves_the_noise():
    (said,) = advised(rmse=1.0, simulation=0.75)
    assert "makes 750 mrad of the 1 rad left of angle" in said
    assert "+parameters.joint.epsilon.guess=0.01 " in said, "three halves, as 0.75 is 7.5 times 0.1"
    (said,) = advised(rmse=1.0, simulation=0.75, noise=1e-3)
    assert "+parameters.joint.epsilon.guess=0.005 " in said, "four at most"


@pytest.mark.parametrize(
    "given",
    [
        {"rmse": 0.29, "simulation": 0.29},
        {"rmse": 1.0, "simulation": 0.7},
        {"rmse": 1.0, "simulation": 0.75, "step": 0.75},
        {"rmse": 1.0, "simulation": 0.75, "noise": np.nan},
        {"rmse": 1.0, "simulation": 0.75, "widths": ()},
    ],
    ids=["near the noise", "half is something else", "the steps err", "noise untold", "no epsilon"],
)
def test_nothing_is_said_where_something_else_decides(given):
    assert advised(**given) == []


def test_the_epsilon_that_is_told_leaves_less():
    """A simulated carriage that sticks, with an epsilon that is four times as wide as its port's."""
    record = EMPSRig().record("identification", duration=6.0)
    effects = ["viscous", "coulomb", "offset", "asymmetric_viscous"]

    def fitted(width):
        adjusted = {"carriage.epsilon": {"guess": width}}
        model = compose(EMPS(), effects, adjustments=adjusted)
        estimate = fit(model, [record], FitSettings(horizon=200))
        advice = judge(model, [record], estimate).advice
        return estimate.left[0], [one.said for one in advice if one.kind == "smoothing"]

    port = next(p for p in EMPS().ports if p.name == "carriage")
    wide, (said,) = fitted(4 * port.epsilon)
    narrow = float(said.partition("epsilon.guess=")[2].split()[0])
    less, _ = fitted(narrow)
    assert narrow == pytest.approx(port.epsilon / 4, rel=0.01), (
        "four halves: the encoder has hardly any noise"
    )
    assert less.rmse < wide.rmse / 4
