"""The verdict's sentence claims no more than the trace's numbers say."""

import pytest

from pipelines.trace.words import sentence

DRAG = {"effect": "quadratic_drag", "port": "carriage", "gain": 0.03, "reason": "5% less is asked"}
SPRING = {"effect": "cubic_stiffness", "port": "carriage", "gain": 0.12, "reason": "k_3 is not determined"}


@pytest.fixture
def nothing():
    """Builds what a trace that names nothing says of the effects it tried."""

    def build(*tried, stopped="no further effect passes"):
        return {
            "verdict": "nothing_missing",
            "accepted": [],
            "rejected": list(tried),
            "stopped": stopped,
            "horizon": 1.0,
            "provenance": "simulated",
            "rules": {"worth": 0.05},
        }

    return build


def test_nothing_gains(nothing):
    said = sentence(nothing(DRAG))
    assert said.endswith(
        "none of the 1 effects tried lowers the error on held-out horizons of 1 s (simulated) by 5 %."
    )


def test_a_gain_that_was_refused_is_told(nothing):
    said = sentence(nothing(DRAG, SPRING))
    assert "none of the 2 effects tried" in said
    assert said.endswith(
        "The largest gain, 12.0 % with cubic_stiffness at carriage, is refused: k_3 is not determined."
    )


def test_nothing_was_tried_because_nothing_is_left(nothing):
    said = sentence(nothing(stopped="the residual meets the noise floor"))
    assert said.endswith("the residual meets the noise floor on held-out horizons of 1 s (simulated).")
