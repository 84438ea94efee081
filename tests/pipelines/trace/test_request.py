"""What a trace is asked for: effects, and the horizon where the config leaves it open."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from hybridid.effects.library import EFFECTS
from hybridid.trace.horizons.split import ENOUGH
from hybridid.trace.rules import Rules
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.trace.request import Request, fitting_horizon, imported_effects, request_of

ASKED = 1.0  # s


@dataclass(frozen=True)
class Recorded:
    """A prepared record of ``n`` samples every ``dt`` s."""

    name: str
    role: str
    n: int
    dt: float = 0.01

    @property
    def seconds(self) -> float:
        return self.n * self.dt


def horizon_of(records, horizon="auto", held_out="auto") -> float:
    section = {"records": ["identification"], "held_out": held_out, "horizon": horizon}
    settings = Settings("made", {"trace": section})
    request = Request(EFFECTS, None, Rules(), ASKED, 1)
    return fitting_horizon(request, records, settings).horizon


@pytest.mark.parametrize(
    ("fitted", "judged", "expected"),
    [(3000, 3000, ASKED), (300, 200, 2.0 / ENOUGH), (200, 3000, 2.0 / ENOUGH)],
)
def test_short_records_get_short_horizons(fitted, judged, expected):
    records = [Recorded("a", "identification", fitted), Recorded("b", "validation", judged)]
    assert horizon_of(records) == pytest.approx(expected)


def test_one_record_serves_both_sides():
    assert horizon_of([Recorded("a", "identification", 600)]) == pytest.approx(3.0 / ENOUGH)


def test_a_horizon_that_is_given_stays():
    records = [Recorded("a", "identification", 300), Recorded("b", "validation", 200)]
    assert horizon_of(records, horizon=1.0) == ASKED


def test_own_effects_are_known_by_their_import_paths_wherever_they_are_named():
    section = {"effects": ["viscous", "lab:CABLE"], "extra_effects": ["lab:WORN"]}
    assert imported_effects(Settings("made", {"trace": section})) == ["lab:CABLE", "lab:WORN"]


def asked(**section):
    return request_of(Settings("emps", {"plant": "hybridid.plants.emps:EMPS", "trace": section}))


def test_effects_that_are_left_out_are_not_tried():
    every = asked()
    assert every.laws
    some = asked(leave_out=["cogging", "viscous"], laws=False)
    assert {e.id for e in every.effects} - {e.id for e in some.effects} == {"cogging", "viscous"}
    assert not some.laws


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ({"leave_out": ["coging"]}, r"unknown effect in trace.leave_out: 'coging': did you mean 'cogging'"),
        ({"effects": ["viscous"], "leave_out": ["viscous"]}, "trace.leave_out names every effect to try"),
    ],
)
def test_a_wrong_effect_to_leave_out_is_one_line(section, said):
    with pytest.raises(ConfigError, match=said):
        asked(**section)
