"""A sweep's page from rows that are known: means over seeds, the choice, what failed, the plan."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest

from pipelines.shared.page import Picture
from pipelines.sweep.conduct import SweepOutcome
from pipelines.sweep.grid import Cell, Group
from pipelines.sweep.plan import Plan
from pipelines.sweep.report import page_of
from pipelines.sweep.rows import Row, Score

AXES = ("residual.depth", "residual.width")
LINES = ("8 points train together in 2 stacks",)


def row_of(point, held_out, unseen):
    """An output's row: 0.1 mm on the record that trained it, ``unseen`` on the other."""
    scores = (Score("first", True, "measured", 1e-4, 0.99), Score("second", False, "measured", unseen, None))
    size = 10 * point.at["residual.depth"] * point.at["residual.width"]
    return Row(point, "position", "m", scores, size, held_out, 2e-3, held_out, held_out)


@pytest.fixture
def grid(points, sweep):
    """The short carriage's grid of 2 x 2 cells, two seeds each; the last seed of all diverges."""
    made = points()
    rows = [row_of(p, 1e-3 * (1 + k), 5e-4) for k, p in enumerate(made)]
    rows[-1] = row_of(made[-1], None, None)
    cells = [
        Cell({axis: own[0].point.at[axis] for axis in AXES}, tuple(own))
        for _, group in itertools.groupby(rows, lambda row: [row.point.at[axis] for axis in AXES])
        for own in [list(group)]
    ]
    group = Group("position", tuple(cells), rows[0], "the smallest within 5 %")
    return SweepOutcome(sweep(made), Plan(2, (), (), (), LINES), {}, 1.0), [group]


def section(page, title):
    return next(one for one in page.sections if one.title == title)


def test_a_row_for_each_cell_with_its_mean_and_spread(grid):
    (table,) = section(page_of(*grid, ()), "Grid").tables
    assert table.caption == "position (measured)"
    columns = ("layers", "neurons a layer", "size", "held-out RMSE", "first", "second, unseen", "")
    assert table.header == columns
    assert table.rows[0] == ("1", "4", "40", "1.50 ± 0.71 mm", "100 ± 0 µm", "500 ± 0 µm", "chosen")
    assert table.rows[-1][3:] == ("7 mm (1 diverged)", "100 ± 0 µm", "500 µm (1 diverged)", "")
    assert [row[-1] for row in table.rows] == ["chosen", "", "", ""]
    assert table.words == (0, 1, 6)
    assert table.notes == ("the gray box alone has an RMSE of 2 mm on the same blocks",)


def test_the_choice_comes_first_with_its_rule_and_command(grid):
    page = page_of(*grid, ())
    chosen = page.sections[0]
    assert chosen.paragraphs[0] == (
        "position: residual.depth=1 residual.width=4 residual.seeds=0 (40 weights), held-out RMSE 1 mm, "
        "the gray box 2 mm (measured)"
    )
    assert chosen.paragraphs[1] == "Rule of choice: the smallest within 5 %."
    coordinates = "residual.depth=1 residual.width=4 residual.seeds=0"
    assert chosen.commands == (f"hybridid run case=short {coordinates}",)
    assert (page.lead, page.marks) == ("8 of 8 points have results.", ("measured",))


def test_points_without_a_result_are_listed_with_the_reason(grid):
    swept, groups = grid
    assert "Failed" not in [one.title for one in page_of(swept, groups, ()).sections]
    lost = swept.sweep.points[3]
    page = page_of(SweepOutcome(swept.sweep, swept.plan, {lost: "killed"}, 1.0), groups, ())
    assert section(page, "Failed").tables[0].rows == ((lost.name, "killed"),)
    assert page.lead == "7 of 8 points have results."


def test_the_page_shows_the_maps_and_how_to_go_on(grid, tmp_path):
    (tmp_path / "heat_map_position.svg").write_text("<svg/>")
    made = page_of(*grid, (Picture(tmp_path / "heat_map_position.svg", "Held-out RMSE"),))
    html = made.write(tmp_path).read_text()
    markdown = (tmp_path / "index.md").read_text()
    assert "data:image/svg+xml;base64," in html
    assert "![Held-out RMSE](heat_map_position.svg)" in markdown
    for text in (html, markdown):
        assert "1.50 ± 0.71 mm" in text
        assert LINES[0] in text
        assert "hybridid sweep case=short" in text


def test_where_no_network_is_better_than_the_gray_box_it_says_so(grid):
    swept, (group,) = grid
    page = page_of(swept, [Group(group.title, group.cells, None, "none")], ())
    said = section(page, "Chosen").paragraphs[0]
    assert said == "position: no network; none is better than the gray box on the held-out blocks"


def test_where_nothing_is_held_out_nothing_is_chosen(grid):
    swept, (group,) = grid
    cells = tuple(
        replace(cell, rows=tuple(replace(row, held_out=None, without=None) for row in cell.rows))
        for cell in group.cells
    )
    group = replace(group, cells=cells)
    page = page_of(swept, [Group(group.title, group.cells, None, "none")], ())
    (table,) = section(page, "Grid").tables
    assert "held-out RMSE" not in table.header
    assert {row[-1] for row in table.rows} == {""}
    assert section(page, "Chosen").paragraphs[0] == "position: nothing is held out, nothing is chosen"
    assert section(page, "Chosen").commands == ()
