"""On a simulated carriage: a declared effect is doubted if structure remains over its own variable."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hybridid.effects.over import Over
from hybridid.trace.ceiling import ceiling
from hybridid.trace.context import Context
from hybridid.trace.doubted import doubted, revision_advised
from hybridid.trace.refit import refit


@pytest.fixture(scope="module")
def fitted(make_model, split_of):
    """The symmetric model of a carriage whose friction differs by direction."""
    split = split_of(df_v=80.0)
    return refit(make_model(), split), split


@pytest.mark.parametrize(
    ("over", "names"),
    [
        (Over("velocity"), ["carriage.viscous", "carriage.coulomb"]),  # an offset is no function of it
        (Over("position", "velocity"), ["carriage.viscous"]),
        (Over("position"), []),
    ],
)
def test_functions_of_the_variable_are_doubted(fitted, over, names):
    base, split = fitted
    found = ceiling(base, split, "carriage", over)
    assert doubted(base.model, base, [found], split) == names


def test_it_is_told_where_nothing_explains_the_errors_and_a_revision_was_not_asked(fitted):
    base, split = fitted
    found = ceiling(base, split, "carriage", Over("velocity"))

    def told(verdict="unexplained", remains=(f"at {found.place}",), **asked):
        search = SimpleNamespace(first=base, final=base)
        ended = SimpleNamespace(
            verdict=verdict, search=search, ceilings=[found], remains=remains, accepted=()
        )
        return revision_advised(ended, Context(split, (), **asked))

    assert told() == (
        " What is declared over that variable (carriage.viscous and carriage.coulomb) may be the wrong law: "
        "trace.revise=true seeks others in its place."
    )
    assert told(revise=True) == told("law_proposed") == ""
    assert told(remains=()) == (
        " The declared carriage.viscous, carriage.coulomb and carriage.offset were not questioned: "
        "trace.revise=true seeks others in the place of each."
    )
