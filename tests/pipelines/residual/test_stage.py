"""The stage ``residual``: a grid of NARX networks and networks inside the equations, from config to files."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from hybridid.records.store import load_record
from hybridid.residuals.choice import NEAR
from hybridid_cli.residual_results import residual_results
from hybridid_cli.tables import rendered
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import load
from pipelines.shared.hybrids import hybrid_of
from pipelines.shared.prepared import prepared_records
from pipelines.shared.storage import read_json
from pipelines.tracking.metrics import metrics_of

RBF = {"kind": "rbf", "nodes": [2, 3], "horizons": [300], "max_iterations": 4, "folds": 2, "processes": 1}


@pytest.fixture
def made(settings, heard, data):
    """``made(section)``: the tree after ``residual``, or after ``last``, with that section in the config."""

    def run(section, last="residual", **changes):
        return run_stages(settings({"residual": section, **changes}), last, heard).tree

    return run


class TestGrid:
    @pytest.fixture
    def tree(self, made, narx_grid, once):
        return once("grid", lambda: made(narx_grid, out="tree"))

    def test_every_size_and_seed_is_a_row(self, tree):
        rows = read_json(tree / "residual/residual.json")["networks"]
        sizes = Counter((row["output"], row["depth"], row["width"], row["seed"]) for row in rows)
        assert set(sizes) == {("position", d, w, s) for d in (1, 2) for w in (4, 6) for s in (0, 1)}
        assert set(sizes.values()) == {1}
        one = next(row for row in rows if (row["depth"], row["width"]) == (2, 6))
        assert one["weights"] == (4 * 6 + 6) + (6 * 6 + 6) + (6 + 1)

    def test_scores_on_every_record_are_those_of_the_hybrid(self, tree):
        """The kept network's row says what its hybrid, read back from its files, simulates."""
        report = read_json(tree / "residual/residual.json")
        (kept,) = [row for row in report["networks"] if row["chosen"]]
        model, estimate = load(tree)
        hybrid = hybrid_of(tree, model)
        assert [(row["record"], row["fitted"]) for row in kept["hybrid"]] == [
            ("first", True),
            ("second", False),
        ]
        for prepared, row, gray in zip(prepared_records(tree), kept["hybrid"], report["gray"], strict=True):
            record = load_record(prepared.file)
            run = hybrid.free_run(record, "estimated", estimate.settings.integrator)
            assert row["rmse"] == pytest.approx(np.sqrt(np.mean(run.error**2)), rel=1e-6)
            assert row["r2"] == pytest.approx(1 - row["mse"] / np.var(run.measured), rel=1e-6)
            assert (row["provenance"], row["unit"]) == ("measured", "m")
            assert gray["record"] == row["record"]
            assert gray["rmse"] != row["rmse"]

    def test_the_file_is_what_its_schema_says(self, tree, fits_schema):
        fits_schema(tree / "residual/residual.json")

    def test_the_choice_keeps_its_rule(self, tree):
        report = read_json(tree / "residual/residual.json")
        rows = report["networks"]
        lowest = min(row["held_out"] for row in rows)
        near = [row for row in rows if row["held_out"] <= NEAR * lowest]
        assert [row for row in near if row["chosen"]] == [
            min(near, key=lambda row: (row["weights"], row["held_out"]))
        ]
        assert "fewest weights" in report["rule"]

    def test_explained_share_is_written_and_said(self, tree):
        report = read_json(tree / "residual/residual.json")
        (explained,) = report["explained"]
        assert explained["record"] == "first"
        assert 0 <= explained["share"] <= 1
        assert set(explained["alone"]) >= {"M", "carriage.viscous.f_v"}
        said = rendered(residual_results(tree))
        assert f"could have explained {explained['share']:.0%}" in said
        assert report["rule"] in said
        assert "2 x 6" in said
        assert "second, unseen" in said

    def test_every_network_is_logged_under_its_own_name(self, tree):
        names = [n for n in metrics_of(tree, ["residual"]) if n.startswith("residual.held_out.")]
        assert len(names) == 8


def test_one_number_is_a_grid_of_one(made, narx_grid):
    rows = read_json(made({**narx_grid, "depth": 1, "width": 4}) / "residual/residual.json")["networks"]
    assert {(row["depth"], row["width"]) for row in rows} == {(1, 4)}


def test_a_network_that_does_not_help_says_so(made, narx_grid):
    """One epoch at a vanishing rate: the network stays as it began, almost nothing; none is kept."""
    section = {**narx_grid, "depth": 1, "width": 4, "epochs": 1, "learning_rate": 1e-9, "seeds": [0]}
    tree = made(section)
    found = read_json(tree / "residual/residual.json")
    (warning,) = [w for w in found["warnings"] if "no correction" in w]
    assert "is better than no correction: running free" in warning
    assert "this output keeps the gray box" in warning
    assert warning in rendered(residual_results(tree))
    (row,) = found["networks"]
    assert (row["chosen"], found["model"]) == (False, "gray box, no network kept")
    model, estimate = load(tree)
    record = load_record(prepared_records(tree)[0].file)
    run = hybrid_of(tree, model).free_run(record, "estimated", estimate.settings.integrator)
    assert np.sqrt(np.mean(run.error**2)) == pytest.approx(found["gray"][0]["rmse"], rel=1e-6)


def test_a_network_that_runs_away_is_caught_and_reported(made, narx_grid, heard, data):
    """A drive a thousand times stronger than any that trained the network: it says where it diverged,
    in the grid's rows and in ``validate``, and the gray box is scored all the same."""
    lines = (data / "second.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines[1:]]
    stronger = [f"{t},{float(force) * 1000:.12g},{mm}" for t, force, mm in rows]
    (data / "second.csv").write_text("\n".join([lines[0], *stronger]) + "\n")
    section = {**narx_grid, "depth": 1, "width": 4, "seeds": [0], "guard": 1.5}
    tree = made(section, "validate")
    (row,) = read_json(tree / "residual/residual.json")["networks"]
    there = {one["record"]: one for one in row["hybrid"]}
    assert there["first"]["rmse"] > 0
    assert there["second"]["rmse"] is None
    assert "the network for position diverged on record second at t = " in there["second"]["remark"]
    scores = [r for r in read_json(tree / "validate/metrics.json") if r["record"] == "second"]
    free = {r["model"]: r for r in scores if r["view"] == "free_run"}
    assert free["gray box"]["rmse"] > 0
    assert free["hybrid, NARX 1 x 4"]["rmse"] is None
    assert "diverged" in free["hybrid, NARX 1 x 4"]["remark"]
    assert any("diverged on record second" in line for line in heard.warned)
    said = rendered(residual_results(tree))
    assert "diverges" in said, "the row's cell"
    assert "diverged on record second" in said, "the warning"


class TestRBF:
    def test_several_nodes_are_chosen_from_on_held_out_blocks(self, made, fits_schema):
        tree = made(RBF, "validate")
        fits_schema(tree / "residual/residual.json")
        report = read_json(tree / "residual/residual.json")
        assert [row["nodes"] for row in report["candidates"]] == [2, 3]
        assert sum(row["chosen"] for row in report["candidates"]) == 1
        assert {tuple(row["gray_rmse"]) for row in report["candidates"]} == {
            tuple(report["candidates"][0]["gray_rmse"])
        }, "one gray box a fold, whatever the network"
        (chosen,) = [row["nodes"] for row in report["candidates"] if row["chosen"]]
        assert report["nodes"] == chosen
        assert 0 <= report["explained"][0]["share"] <= 1
        models = {row["model"] for row in read_json(tree / "validate/metrics.json")}
        assert models == {"gray box", f"hybrid, RBF with {chosen} nodes"}
        assert "held-out RMSE" in rendered(residual_results(tree))

    def test_fixed_physics_stays(self, made):
        tree = made({**RBF, "nodes": [2], "physics": "fixed"})
        values = read_json(tree / "residual/hybrid.json")["values"]
        gray = load(tree)[1].values
        assert {name: values[name] for name in gray} == pytest.approx(gray)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"depth": []}, "residual.depth is []"),
        ({"width": [8, 0]}, "residual.width is 0: at least 1"),
        ({"outputs": ["speed"]}, "speed"),
        ({"height": 3}, "height"),
        ({"kind": "narks"}, "narks"),
    ],
)
def test_refusals_of_a_grid(made, narx_grid, changes, words):
    _refused(made, {**narx_grid, **changes}, words)


def test_refusal_of_no_nodes(made):
    _refused(made, {**RBF, "nodes": [0]}, "residual.nodes is 0")


def _refused(made, section, words):
    with pytest.raises(ConfigError) as refused:
        made(section)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
