"""The study of the servo: a form that cannot be fitted takes no other form with it."""

from __future__ import annotations

import math

from benchmarks import servo
from hybridid.rigs.servo import ServoRig

STIFF = ("viscous", "coulomb", "dahl", "joint.dahl.s=1e-9")
"""A bristle of 1e-9 rad, which the case's integrator cannot follow."""


def test_a_form_too_stiff_to_fit_is_the_worst_and_not_the_end(monkeypatch):
    monkeypatch.setattr(servo, "FORMS", {"stiff": STIFF, "M1": servo.FORMS["M1"]})
    records = {f"{kind}_kp400": ServoRig().record(f"{kind}_kp400", duration=1.0) for kind in servo.KINDS}
    assert servo.fitted("stiff", records) is None
    assert servo.across("stiff", records, records) == math.inf
    assert servo.outcome_of(None) == "too stiff to fit"
    said: list[str] = []
    assert servo.chosen(servo.KINDS[0], records, ["stiff", "M1"], said.append) == "M1"
    assert "stiff inf" in said[0]
