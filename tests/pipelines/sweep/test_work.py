"""A stack's points have the very results that each would have had alone."""

from __future__ import annotations

import numpy as np

from pipelines.runner import is_fresh, run_stages
from pipelines.shared.storage import read_json
from pipelines.sweep.work import SweepJob, adopt, carry_out


def networks(tree):
    return read_json(tree / "residual/residual.json")["networks"]


def test_stacked_points_are_those_of_hybridid_residual(points, heard, tmp_path):
    found = points()
    assert carry_out(SweepJob("gray", (found[0],), gray=True), heard) == {}
    assert carry_out(SweepJob("all", tuple(found)), heard) == {}
    for point in found[::3]:
        assert is_fresh(point.settings, "residual", point.tree)
        config = {**point.settings.config, "out": str(tmp_path / point.key)}
        alone = run_stages(type(point.settings)("short", config), "residual", heard).tree
        (one,), (other,) = networks(point.tree), networks(alone)
        assert (one["depth"], one["width"], one["seed"]) == (
            point.at["residual.depth"], point.at["residual.width"], point.at["residual.seeds"],
        )  # fmt: skip
        assert one["stopped"] == other["stopped"]
        np.testing.assert_allclose(one["held_out"], other["held_out"], rtol=1e-6)
        np.testing.assert_allclose(one["hybrid"][1]["rmse"], other["hybrid"][1]["rmse"], rtol=1e-6)


def test_a_point_takes_over_its_gray_box_without_doing_it_again(points, heard):
    (point, *_) = points()
    carry_out(SweepJob("gray", (point,), gray=True), heard)
    point.tree.mkdir(parents=True)
    adopt(point)
    before = (point.tree / "fit/stage.json").stat().st_ino
    adopt(point)
    assert (point.tree / "fit/stage.json").stat().st_ino == before
    assert run_stages(point.settings, "fit", heard).ran == ()


def test_one_that_fails_leaves_those_that_train_with_it(points, heard):
    """Orders that reach farther back than a block is long cannot be trained."""
    found = points({"residual.seeds": 0}, {"residual.seeds": 0, "residual.orders.error": 150})
    carry_out(SweepJob("gray", (found[0],), gray=True), heard)
    failures = carry_out(SweepJob("all", tuple(found)), heard)
    too_far = {p.key for p in found if p.at.get("residual.orders.error") == 150}
    assert set(failures) == too_far
    assert all("shorten them" in reason for reason in failures.values())
    assert all((p.tree / "residual/residual.json").exists() for p in found if p.key not in too_far)
