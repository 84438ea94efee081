"""Where a narrow smoothing of sign(v) makes each trial slow, the search says so at once (simulated)."""

from __future__ import annotations

import pytest

from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.search.many_steps import MANY, many_steps
from hybridid.trace.search.search import search


@pytest.mark.parametrize(("width", "slow"), [(2e-5, True), (2e-3, False)])
def test_a_narrow_smoothing_is_told_with_a_wider_one(make_model, split_of, width, slow):
    split = split_of()
    model = make_model(adjust={"carriage.epsilon": {"guess": width}})
    base = refit(model, split, [{"M": 95.0, "carriage.viscous.f_v": 203.0, "carriage.coulomb.f_c": 20.4}])
    assert (base.substeps >= MANY) is slow
    said = many_steps(base, split)
    assert bool(said) is slow
    if slow:
        assert said.startswith(f"a sample takes {base.substeps} steps, as sign(v) is smoothed so narrowly")
        assert f"with +parameters.carriage.epsilon.guess={4 * width:.2g} it takes " in said


def test_the_search_says_it_before_its_first_step(make_model, split_of, monkeypatch):
    monkeypatch.setattr(
        "hybridid.trace.search.search.many_steps", lambda base, split: "a sample takes 50 steps"
    )
    said = []
    search(make_model(), Context(split_of(), (), say=said.append), [{}])
    assert said[0] == "a sample takes 50 steps"
