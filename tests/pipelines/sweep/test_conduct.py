"""A whole sweep: gray box once, failures named, the same again does what is missing and no more."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from statistics import fmean, stdev

import pytest

from hybridid.quantities import percent
from hybridid.residuals.choice import NEAR
from hybridid_cli.sweep_results import failed, summary
from pipelines.shared.errors import ConfigError
from pipelines.shared.sections.searches import SweepSection
from pipelines.sweep.conduct import conduct
from pipelines.sweep.log import common
from pipelines.sweep.report import write_report
from pipelines.tracking.parent_run import parent_run

REQUEST = SweepSection()


@pytest.fixture
def done(sweep, runner, heard):
    """``done(points)``: what became of them."""

    def run(points, own=None, request=REQUEST):
        own = own or runner()
        asked = sweep(points)
        with parent_run(common(points), asked.name, asked.key, heard) as parent:
            return conduct(asked, own, request, parent, heard), own

    return run


def test_a_sweep_ends_in_a_table_a_map_and_a_choice(points, done, fits_schema):
    swept, runner = done(points({"residual.horizons": [10]}))
    groups = write_report(swept)
    folder = swept.sweep.folder
    assert swept.failures == {}
    assert len(runner.grays) == 1

    fits_schema(folder / "sweep.json")
    data = json.loads((folder / "sweep.json").read_text())
    (output,) = data["outputs"]
    assert output["provenance"] == "measured"
    assert len(output["cells"]) == 4

    rows = list(csv.DictReader((folder / "networks.csv").open()))
    errors: dict[int, list[float]] = {}
    for row in rows:
        errors.setdefault(int(row["size"]), []).append(float(row["held_out_rmse"]))
    (kept,) = [row for row in rows if row["chosen"] == "True"]
    best = min(errors.values(), key=fmean)
    limit = max(NEAR * fmean(best), fmean(best) + stdev(best) / 2**0.5)
    size = min(size for size, seeds in errors.items() if fmean(seeds) <= limit)
    assert (int(kept["size"]), float(kept["held_out_rmse"])) == (size, min(errors[size]))
    assert output["chosen"]["tree"] == kept["tree"]

    page = (folder / "index.md").read_text()
    assert f"one standard error of the lowest, or within {percent(NEAR - 1)} if that is more" in page
    assert "heat_map_position.svg" in page
    said = summary(swept, groups)
    assert "chosen for position" in said
    assert "hybridid run case=short residual.horizons=[10]" in said.replace("'", "")
    assert str(folder / "index.html") in said


def test_validation_records_take_no_part_in_the_choice(points, done):
    swept, _ = done(points({"residual.seeds": 0}))
    (group,) = write_report(swept)
    for point in swept.done:  # as if the chosen network were the worst there
        path = point.tree / "residual/residual.json"
        report = json.loads(path.read_text())
        for row in report["networks"]:
            row["hybrid"][1]["rmse"] = 1e3 if point is group.chosen.point else 0.0
        path.write_text(json.dumps(report))
    (again,) = write_report(swept)
    assert again.chosen.point is group.chosen.point


class TestFailures:
    def test_a_killed_job_is_named_and_the_same_again_does_it_alone(self, points, done, runner):
        found = points({"residual.seeds": 0})
        lost = found[1].name
        swept, _ = done(found, runner(kills=(lost,)), SweepSection(stack=1))
        assert [p.name for p in swept.failures] == [lost]
        write_report(swept)
        assert lost in (swept.sweep.folder / "index.md").read_text().partition("Failed")[2]
        assert lost in failed(swept)
        assert "killed" in failed(swept)

        again, own = done(points({"residual.seeds": 0}))
        assert again.failures == {}
        assert again.sweep.folder == swept.sweep.folder
        assert [p.name for work in own.jobs for p in work.points] == [lost]
        assert own.grays == []

    def test_a_point_that_cannot_be_is_refused_and_the_others_run(self, points, done):
        swept, _ = done(points({"residual.seeds": 0}, {"residual.seeds": 0, "effects": ["viscos"]}))
        assert len(swept.done) == 4
        assert all("did you mean 'viscous'?" in reason for reason in swept.failures.values())
        assert len(swept.failures) == 4

    def test_nothing_to_carry_out_is_a_wrong_request(self, points, done):
        with pytest.raises(ConfigError, match="did you mean 'viscous'"):
            done(points({"effects": ["viscos"]}))

    def test_a_gray_box_that_fails_is_named_for_all_that_stand_on_it(self, points, done, monkeypatch):
        found = points({"residual.seeds": 0}, {"residual.seeds": 0, "estimator.horizon": 150})
        from pipelines import fit

        real = fit.fit

        def failing(model, records, settings, report=None):
            if settings.horizon == 150:
                raise ValueError("no way")
            return real(model, records, settings, report)

        monkeypatch.setattr(fit, "fit", failing)
        swept, _ = done(found)
        assert {p.settings["estimator.horizon"] for p in swept.failures} == {150}
        assert {*swept.failures.values()} == {"its gray box: ValueError: no way"}
        assert len(swept.done) == 4


class TestAgain:
    def test_nothing_is_done_twice_and_a_larger_grid_does_the_rest(self, points, done):
        done(points({"residual.seeds": 0}))
        same, own = done(points({"residual.seeds": 0}))
        assert own.jobs == own.grays == []
        assert len(same.plan.fresh) == 4
        _, own = done(points({"residual.seeds": 0, "residual.width": [4, 6, 8]}))
        assert {p.at["residual.width"] for work in own.jobs for p in work.points} == {8}

    def test_another_config_or_other_code_makes_a_point_stale(self, points, done, monkeypatch):
        done(points({"residual.seeds": 0}))
        _, own = done(points({"residual.seeds": 0, "residual.epochs": 3}))
        assert sum(len(work.points) for work in own.jobs) == 4
        monkeypatch.setattr("pipelines.shared.freshness.code_of", lambda module: {"hybridid.model": "other"})
        _, own = done(points({"residual.seeds": 0}))
        assert sum(len(work.points) for work in own.jobs) == 4
        assert len(own.grays) == 1

    def test_force_does_all(self, points, done):
        done(points({"residual.seeds": 0}))
        _, own = done([replace_force(p) for p in points({"residual.seeds": 0})])
        assert sum(len(work.points) for work in own.jobs) == 4


def replace_force(point):
    config = {**point.settings.config, "force": True}
    return type(point)(replace(point.settings, config=config), point.at)


def test_gray_boxes_alone_are_compared_and_none_is_chosen(points, done):
    swept, own = done(points({"estimator.horizon": 150}, {"estimator.horizon": 300}, residual=None))
    (group,) = write_report(swept)
    assert own.grays == []
    assert group.chosen is None
    assert "nothing is chosen" in summary(swept, [group])
    assert "heat_map_position.svg" in (swept.sweep.folder / "index.md").read_text()


def test_radial_basis_functions_are_chosen_by_their_own_rule(points, done):
    section = {
        "kind": "rbf",
        "nodes": [2, 3],
        "horizons": [300],
        "max_iterations": 3,
        "folds": 2,
        "processes": 1,
    }
    swept, _ = done(points(residual=section))
    assert swept.failures == {}
    (group,) = write_report(swept)
    assert "within one standard error" in group.rule
    assert group.chosen.held_out is not None
    assert {row.size for cell in group.cells for row in cell.rows} == {2, 3}
