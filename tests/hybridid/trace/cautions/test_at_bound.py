"""A parameter that runs to its bound in the last model is told, with the wider bound to go on with."""

from __future__ import annotations

from types import SimpleNamespace

from hybridid.trace.cautions.at_bound import ends_at_bound


def _told(*parameters: tuple[str, float, float, float, bool]) -> str:
    named = [
        SimpleNamespace(name=f"joint.maxwell.{name}", value=v, lower=a, upper=b, unit="s", at_bound=at)
        for name, v, a, b, at in parameters
    ]
    return ends_at_bound(SimpleNamespace(parameters=named))


def test_the_upper_bound_is_told_with_a_wider_one():
    assert _told(("tau", 0.075, 2.5e-5, 0.075, True)) == (
        " Beware: tau of joint.maxwell ends at its upper bound, 75 ms. The machine's own may lie beyond, and "
        "the others make up for it: go on with a wider one, as parameters.joint.maxwell.tau.upper=0.75."
    )


def test_each_bound_is_widened_away_from_what_is_allowed():
    assert _told(("tau", 0.01, 0.01, 1.0, True)).endswith(".lower=0.001.")
    assert _told(("q_0", -3.0, -3.0, 3.0, True)).endswith(".lower=-30.")
    assert _told(("q_0", -0.5, -3.0, -0.5, True)).endswith(".upper=-0.05.")


def test_what_is_inside_or_at_a_bound_of_zero_is_not_told():
    assert _told(("tau", 0.05, 0.01, 1.0, False), ("k", 0.0, 0.0, 9.0, True)) == ""


def test_one_of_the_plant_is_told_though_nothing_was_accepted():
    mass = SimpleNamespace(name="M", value=1600.0, lower=1600.0, upper=2000.0, unit="kg", at_bound=True)
    assert ends_at_bound(SimpleNamespace(parameters=[mass])) == (
        " Beware: M ends at its lower bound, 1600 kg. Unless physics sets that bound, the machine's own may "
        "lie beyond, and the others make up for it: parameters.M.lower sets another one."
    )
