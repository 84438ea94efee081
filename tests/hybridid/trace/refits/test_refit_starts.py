"""Where a refit begins, and when its end is too stiff."""

from dataclasses import replace

import pytest

from hybridid.simulation.stability import MOST
from hybridid.trace.refits.numerics import DECLARED, Numerics
from hybridid.trace.refits.refit import refit
from hybridid.trace.refits.refit_starts import STIFF, is_too_stiff, most_steps, room_beside


def test_a_start_that_is_left_out_as_too_stiff_is_told(make_model, split_of):
    """Dahl friction over a nanometre: RK4 would need hundreds of steps a sample there."""
    model, split = make_model(("viscous", "coulomb", "dahl")), split_of()
    mild = {"carriage.dahl.f_c": 1.0, "carriage.dahl.s": 1e-2}
    short = {"carriage.dahl.f_c": 20.0, "carriage.dahl.s": 1e-6}
    assert Numerics().steps(model, model.values(short), split) > STIFF
    assert refit(model, split, [mild]).unsolved == ()
    assert refit(model, split, [mild, short]).unsolved == (1,)


def test_only_what_an_effect_adds_to_the_steps_is_its_stiffness(make_model, split_of):
    base = refit(make_model(), split_of())
    assert room_beside(None) == room_beside(replace(base, substeps=2)) == STIFF
    assert room_beside(replace(base, substeps=10)) == 15
    finer = replace(base, substeps=20, numerics=replace(base.numerics, finer=2))
    assert room_beside(finer) == 15
    assert most_steps(None) == most_steps(base) == MOST
    assert most_steps(replace(base, substeps=MOST)) == 75, "as many as its base takes"


@pytest.mark.parametrize(
    ("integrator", "wanted", "too_stiff"),
    [("rk4", 15, False), ("rk4", 27, False), ("rk4", 28, True), ("rodas3", 15, False), ("rodas3", 16, True)],
)
def test_an_end_at_which_rk4_is_stable_is_not_too_stiff(make_model, split_of, integrator, wanted, too_stiff):
    """There is room for 15 steps a sample. RK4 asks for 1.5 / |eigenvalue| and is stable up to 2.78."""
    ten = replace(refit(make_model(), split_of()), substeps=10)
    assert is_too_stiff(wanted, ten, replace(DECLARED, integrator=integrator)) == too_stiff
