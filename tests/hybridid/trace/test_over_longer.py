"""Where longer horizons show more than what was accepted over short ones: which conclusion counts then."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from hybridid.trace import over_longer
from hybridid.trace.over_longer import concluded
from hybridid.trace.rules import Rules
from hybridid.trace.search.longer import Longer


@dataclass(frozen=True)
class Found:
    """A conclusion: the classes of what it accepted, and times the noise that it leaves."""

    classes: tuple[tuple[str, ...], ...] = ()
    times: float = 1.0
    longer: Longer | None = None
    noisy: object = None
    grows: Longer | None = None

    @property
    def search(self):
        return SimpleNamespace(final=None)

    @property
    def accepted(self):
        return tuple(
            SimpleNamespace(
                name=names[0], alike=[SimpleNamespace(candidate=SimpleNamespace(name=n)) for n in names[1:]]
            )
            for names in self.classes
        )


SHORT, LONG = "short horizons", "long horizons"
MORE = Longer(2.0, 1.3)
LAG, ALIKE, SLOW = ("torque.input_lag",), ("angle.sensor_lag", "torque.input_lag"), ("joint.coulomb",)


@pytest.fixture
def conclusions(monkeypatch):
    """``conclusions(first, second, longer)``: those over the short and the long horizons."""

    def concluding(first, second=None, longer=None, out_of_time=False, noise=False):
        context = SimpleNamespace(split=SHORT, rules=Rules(), out_of_time=out_of_time, say=lambda text: None)
        there = SimpleNamespace(split=LONG)
        by_split = {SHORT: first, LONG: second}
        monkeypatch.setattr(over_longer, "declared_starts", lambda *_: [])
        monkeypatch.setattr(over_longer, "numerics_for", lambda *_: None)
        monkeypatch.setattr(over_longer, "over_long_enough", lambda model, context, *_: context)
        monkeypatch.setattr(over_longer, "conclude", lambda model, context, *_: by_split[context.split])
        monkeypatch.setattr(over_longer, "lengthened", lambda *_: there)
        monkeypatch.setattr(over_longer, "more_over_longer", lambda final, context, above: longer)
        monkeypatch.setattr(over_longer, "made_by_noise", lambda *_: noise)
        found, context = concluded(None, context, [], "auto", may_lengthen=True)
        return found, context.split

    return concluding


@pytest.mark.parametrize("first", [(LAG,), (LAG[:1],)])
@pytest.mark.parametrize("second", [(LAG, SLOW), (ALIKE, SLOW)])
def test_what_holds_each_name_and_more_counts(conclusions, first, second):
    assert conclusions(Found(first), Found(second), MORE) == (Found(second), LONG)


@pytest.mark.parametrize("second", [(), (LAG,), (SLOW, ("joint.offset",))])
def test_what_names_no_more_or_others_does_not_and_the_longer_horizons_are_told(conclusions, second):
    assert conclusions(Found((LAG,)), Found(second), MORE) == (Found((LAG,), grows=MORE), SHORT)


@pytest.mark.parametrize(
    "first", [Found((LAG,), noisy=object()), Found((LAG,), times=1.5), Found((), times=1.0)]
)
def test_none_is_asked_where_noise_of_an_input_or_more_than_the_noise_is_left_or_nothing_accepted(
    conclusions, first
):
    assert conclusions(first, longer=MORE) == (first, SHORT)


@pytest.mark.parametrize("longer", [None, Longer(2.0, 1.3, judged=False)])
def test_none_is_asked_where_they_show_no_more_or_cannot_judge(conclusions, longer):
    assert conclusions(Found((LAG,)), longer=longer) == (Found((LAG,)), SHORT)


def test_none_is_asked_where_noise_of_an_input_makes_what_they_leave(conclusions):
    assert conclusions(Found((LAG,)), longer=MORE, noise=True) == (Found((LAG,)), SHORT)


def test_none_is_asked_after_the_time_limit(conclusions):
    assert conclusions(Found((LAG,)), longer=MORE, out_of_time=True) == (Found((LAG,)), SHORT)


def test_they_are_searched_where_nothing_was_found_and_they_leave_more(conclusions):
    first, second = Found((), longer=Longer(2.0, 3.5)), Found((SLOW,))
    assert conclusions(first, second) == (second, LONG)
