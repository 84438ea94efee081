"""Points: lists of a grid taken apart, coordinates, what they share."""

from __future__ import annotations

import json

import pytest

from pipelines.sweep.point import Point, axes_of, spelt


def test_lists_of_a_grid_become_points_of_one_value_each(points):
    found = points()
    assert len(found) == 2 * 2 * 2
    assert {(p.at["residual.depth"], p.at["residual.width"], p.at["residual.seeds"]) for p in found} == {
        (d, w, s) for d in (1, 2) for w in (4, 6) for s in (0, 1)
    }
    assert all(p.settings["residual.depth"] == p.at["residual.depth"] for p in found)
    assert found[0].name == "residual.depth=1 residual.width=4 residual.seeds=0"


def test_swept_values_multiply_the_grid_and_are_coordinates(points):
    found = points({"residual.orders.error": 1}, {"residual.orders.error": 2})
    assert len(found) == 16
    assert axes_of(found) == [
        "residual.orders.error", "residual.depth", "residual.width", "residual.seeds",
    ]  # fmt: skip


def test_equal_configs_are_one_point(points):
    assert len(points({}, {})) == 8


def test_points_of_one_gray_box_share_its_tree_and_no_other(points):
    found = points({}, {"estimator.horizon": 150})
    assert len({p.tree for p in found}) == 16
    assert len({p.gray_tree for p in found}) == 2
    assert {p.tree for p in found}.isdisjoint(p.gray_tree for p in found)


def test_radial_basis_functions_are_judged_on_blocks_though_one_size_is_no_choice(points):
    section = {"kind": "rbf", "nodes": [2, 3], "horizons": [300, None], "folds": 2}
    found = points(residual=section)
    assert [p.at["residual.horizons"] for p in found] == [[300], [None], [300], [None]]
    assert all(p.settings["residual.judged"] for p in found)
    assert found[0].last == "validate"


def test_without_a_network_a_point_is_its_gray_box(points):
    (found,) = points(residual=None)
    assert found.kind is None
    assert found.tree == found.gray_tree


def test_held_out_errors_compare_where_records_and_blocks_are_the_same(points):
    same = points({}, {"estimator.horizon": 150}, {"residual.orders.gray": 2})
    other = points(
        {"residual.blocks": 5}, {"preprocess.steps": [{"step": "remove_mean", "signals": ["force"]}]}
    )
    assert len({p.judged_on for p in same}) == 1
    assert len({p.judged_on for p in [*same, *other]}) == 3


def test_a_point_survives_json(points):
    for one in points():
        again = Point.of(json.loads(json.dumps(one.plain())))
        assert (again.key, again.name, again.tree) == (one.key, one.name, one.tree)


@pytest.mark.parametrize(
    ("value", "text"), [([300, None], "[300,null]"), (True, "true"), (1e-3, "0.001"), ({"a": 1}, "{a:1}")]
)
def test_values_are_spelt_as_hydra_reads_them(value, text):
    assert spelt(value) == text
