"""The plan: who trains together, who alone, and what has to be done first."""

from __future__ import annotations

import pytest

from hybridid.residuals.settings import SMALL
from pipelines.sweep.plan import A_JOB, cost, planned


def names(works):
    return sorted(point.name for work in works for point in work.points)


def test_small_networks_fill_as_many_stacks_as_there_are_cores(points):
    found = points()
    plan = planned(found, [], [], cores=2)
    assert len(plan.jobs) == 2
    assert names(plan.jobs) == sorted(point.name for point in found)
    assert len(plan.grays) == 1
    assert "8 points train together in 2 stacks" in " ".join(plan.lines)


def test_no_cut_in_two_of_the_ordered_points_is_cheaper(points):
    found = points({"residual.width": [4, 8, 16, 32, 64]})
    plan = planned(found, [], [], cores=2)
    ordered = sorted(found, key=lambda p: (p.at["residual.width"], p.at["residual.depth"]))
    best = min(max(cost(ordered[:k]), cost(ordered[k:])) for k in range(1, len(ordered)))
    assert max(cost(work.points) for work in plan.jobs) == pytest.approx(best)


def test_wide_networks_are_jobs_of_their_own_and_the_dearest_begins(points):
    plan = planned(points({"residual.width": [4, 2 * SMALL, 4 * SMALL]}), [], [], cores=2)
    alone = [work for work in plan.jobs if len(work.points) == 1]
    assert [work.points[0].at["residual.width"] for work in plan.jobs[:4]] == [4 * SMALL] * 4
    assert len(alone) == 8
    assert "8 points are jobs of their own" in " ".join(plan.lines)


def test_networks_on_other_gray_boxes_or_of_other_training_are_not_stacked(points):
    found = points({}, {"estimator.horizon": 150}, {"residual.epochs": 3})
    plan = planned(found, [], [], cores=1)
    assert sorted(len(work.points) for work in plan.jobs) == [8, 8, 8]
    assert len(plan.grays) == 2


def test_groups_that_cannot_be_stacked_share_the_cores(points):
    found = points({}, {"estimator.horizon": 150})
    assert [len(work.points) for work in planned(found, [], [], cores=2).jobs] == [8, 8]


def test_other_orders_are_stacked(points):
    plan = planned(points({}, {"residual.orders.error": 1}), [], [], cores=1)
    assert [len(work.points) for work in plan.jobs] == [16]


def test_what_is_fresh_is_left_out(points):
    found = points()
    plan = planned(found, found[:7], found[:1], cores=2)
    assert names(plan.jobs) == [found[7].name]
    assert plan.grays == ()
    assert plan.fresh == tuple(found[:7])


def test_a_stack_holds_no_more_than_asked_and_on_a_cluster_no_more_than_a_job_may_lose(points):
    found = points({"residual.seeds": list(range(10))})
    assert len(planned(found, [], [], cores=2, most=1).jobs) == len(found) == 40
    cluster = planned(found, [], [], cores=None)
    assert sum(len(work.points) for work in cluster.jobs) == 40
    assert len(cluster.jobs) == -(-40 // A_JOB)
