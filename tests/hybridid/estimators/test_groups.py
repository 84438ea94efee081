"""Parameters with a value for each group of records: told apart where they differ, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.estimators.differences import chi_square
from hybridid.estimators.words import differ_together, differs
from hybridid.model.groups import of_group
from hybridid.quality import judge

NOISE = 1e-5
F_C, F_V = "carriage.coulomb.f_c", "carriage.viscous.f_v"
AB = ("a", "b")
SETTINGS = FitSettings(horizon=100, substeps=2)


@pytest.fixture(scope="module")
def model(make_model):
    """``model(names)``: the symmetric carriage; the parameters ``names`` differ between records a and b."""
    return lambda *names: replace(make_model(), groups=dict.fromkeys(names, AB))


@pytest.fixture(scope="module")
def pair(carriage_like, noise):
    """``pair(f_c of a, f_c of b, seed)``: two recordings, simulated."""

    def make(f_a, f_b, seed=0, n=600):
        made = (carriage_like(f_c=f) for f in (f_a, f_b))
        return [one.record(n, noise=noise(n, NOISE, seed=2 * seed + k)) for k, one in enumerate(made)]

    return make


def with_weights(record, model, weights):
    """The record with the weights of the groups a and b, of every parameter of ``model`` that has them."""
    values = {of_group(name, g): weights[k] for name in model.groups for k, g in enumerate(AB)}
    return record.with_constants(values, dict.fromkeys(values, "1"))


def recorded(model, pair):
    """Records a and b, each with the weight 1 for its own group."""
    return [with_weights(r, model, w) for r, w in zip(pair, ((1, 0), (0, 1)), strict=True)]


def fitted(model, pair, settings=SETTINGS):
    return fit(model, recorded(model, pair), settings)


@pytest.mark.parametrize("method", ["gauss_newton", "multiple_shooting"])
def test_with_every_parameter_by_record_it_is_two_fits(model, pair, method):
    settings = replace(SETTINGS, method=method, tolerance=1e-12)
    records = pair(20.0, 21.0, n=200)
    plain = model()
    together = fitted(model(*(p.name for p in plain.free)), records, settings).values
    for group, record in zip(AB, records, strict=True):
        alone = fit(plain, [record], settings)
        for p in alone.parameters:
            assert together[of_group(p.name, group)] == pytest.approx(p.value, rel=1e-7), p.name


def test_a_planted_difference_is_found(model, pair):
    found = fitted(model(F_C), pair(20.0, 21.0))
    a, b = (next(p for p in found.parameters if p.name == of_group(F_C, g)) for g in AB)
    for p, truth in ((a, 20.0), (b, 21.0)):
        assert abs(p.value - truth) < 3 * p.std
    (one,) = found.differences
    assert (one.parameter, one.unit, one.groups, one.test.degrees) == (F_C, "N", AB, 1)
    assert (one.lowest, one.highest) == (a.value, b.value)
    assert one.spread == pytest.approx((b.value - a.value) / np.sqrt(2))
    assert one.test.p_value < 1e-9
    std = (b.value - a.value) / np.sqrt(one.test.chi_square)
    assert abs(b.value - a.value - 1.0) < 3 * std < 0.1
    assert differs(one).startswith(f"{F_C} differs by recording: 19.99 to 20.99 N, spread 0.71 N, p < 10")


def test_what_does_not_differ_is_not_said_to(model, pair):
    p = [fitted(model(F_C), pair(20.0, 20.0, seed)).differences[0].test.p_value for seed in range(12)]
    assert sum(one < 0.05 for one in p) <= 2
    assert 0.15 < np.median(p) < 0.85


def test_of_several_parameters_the_one_that_differs_is_named(model, pair):
    found = {one.parameter: one for one in fitted(model(F_C, F_V), pair(20.0, 21.0)).differences}
    assert found[F_C].test.p_value < 1e-4
    assert found[F_V].test.p_value > 0.01
    assert "does not differ noticeably" in differs(found[F_V])


def test_collinear_parameters_differ_together(model, pair):
    """Each could be one value; that all are cannot be."""
    names = (F_C, F_V, "carriage.offset.offset")
    assert fitted(model(F_C), pair(20.0, 21.0)).together is None
    apart, alike = (fitted(model(*names), pair(20.0, f_c)).together for f_c in (21.0, 20.0))
    assert apart.degrees == alike.degrees == 3
    assert apart.p_value < 1e-9
    assert alike.p_value > 0.01
    assert differ_together(apart).startswith("together they differ by recording: p <")
    assert differ_together(alike).startswith("together they do not differ noticeably by recording: p = 0.")


def test_weights_of_a_mean_give_the_mean(model, pair):
    (record, _), grouped = pair(20.0, 21.0), model(F_C)
    u, x = with_weights(record, grouped, (0.5, 0.5)).inputs[300], [0.1, 0.05]
    values = {of_group(F_C, "a"): 18.0, of_group(F_C, "b"): 22.0}
    mean = model()
    expected = mean.f(0.0, x, record.inputs[300], mean.values({F_C: 20.0}))
    assert grouped.f(0.0, x, u, grouped.values(values)).full() == pytest.approx(expected.full(), rel=1e-15)


def test_a_term_that_is_left_out_keeps_its_weights_among_the_inputs(model, pair):
    grouped = model(F_C)
    poorer = grouped.without("carriage.coulomb")
    assert [s.name for s in poorer.inputs] == [s.name for s in grouped.inputs]
    assert not fitted(poorer, pair(20.0, 21.0)).differences


def test_adjustments_are_of_all_groups_or_of_one(make_model):
    adjustments = {F_C: {"lower": 10.0, "upper": 30.0}, of_group(F_C, "b"): {"fixed": 20.0}}
    adjusted = replace(make_model(adjust={}), groups={F_C: AB}, adjustments=adjustments)
    a, b = (p for p in adjusted.parameters if p.name in adjusted.names_of(F_C))
    assert (a.lower, a.upper, a.fixed) == (10.0, 30.0, False)
    assert (b.guess, b.fixed) == (20.0, True)


def test_a_fit_that_is_not_trusted_states_no_test(model, pair):
    grouped = model(F_C)
    records = recorded(grouped, pair(20.0, 21.0))
    found = fit(grouped, records, replace(SETTINGS, max_iterations=1))
    assert not found.converged
    assert np.isnan(found.differences[0].test.p_value)
    withheld = judge(grouped, records, found).withheld(fitted(grouped, pair(20.0, 21.0)))
    assert np.isnan(withheld.differences[0].test.chi_square)
    assert "without standard errors" in differs(withheld.differences[0])


def test_chi_square_of_independent_estimates_is_the_weighted_sum():
    v, std = np.array([20.0, 20.5, 21.5]), np.array([0.2, 0.3, 0.4])
    mean = np.sum(v / std**2) / np.sum(1 / std**2)
    expected = np.sum(((v - mean) / std) ** 2)
    assert chi_square([v], np.diag(std**2)) == pytest.approx(expected)
    # an error that all share makes no difference
    assert chi_square([v], np.diag(std**2) + 9.0) == pytest.approx(expected)
    twice = np.kron(np.eye(2), np.diag(std**2))
    assert chi_square([v, v + 3], twice) == pytest.approx(2 * expected)
    assert np.isnan(chi_square([v], np.diag([1.0, np.inf, 1.0])))
    assert np.isnan(chi_square([v], np.zeros((3, 3))))
