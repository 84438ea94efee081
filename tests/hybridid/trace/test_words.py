"""The verdict's sentence claims no more than the trace's numbers say."""

import math

import pytest

from hybridid.trace.entries import TriedEffect
from hybridid.trace.result import Estimates, LearnedGains, Trace
from hybridid.trace.rules import Rules
from hybridid.trace.words import sentence


def tried(effect: str, gain: float, reason: str) -> TriedEffect:
    return TriedEffect(effect, "carriage", "rejected", reason, 1, gain, 1.0, {}, math.nan)


DRAG = tried("quadratic_drag", 0.03, "5% less is asked")
SPRING = tried("cubic_stiffness", 0.12, "k_3 is not determined")


@pytest.fixture
def nothing():
    """Builds a trace that names nothing, of the effects it tried."""

    def build(*rejected, stopped="no further effect passes"):
        return Trace(
            provenance="simulated",
            verdict="nothing_missing",
            sentence="",
            accepted=(),
            rejected=rejected,
            before=(),
            after=(),
            noise_floor={},
            seconds=1.0,
            declared=(),
            effects=(),
            estimates=Estimates({}, {}),
            path=(),
            ceilings=LearnedGains((), ()),
            remains=(),
            completeness=None,
            stopped=stopped,
            split="",
            horizon=1.0,
            horizons=(4, 4),
            rules=Rules(),
            records=(),
            steps=(),
        )

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
