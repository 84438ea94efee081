"""The thesis page from made-up run trees: chapters, their data, what failed, which figures are there."""

from __future__ import annotations

import pytest

from pipelines.shared.config import Settings
from pipelines.thesis import chapter5, chapter6
from pipelines.thesis.look_up import Failed
from pipelines.thesis.page import CHAPTERS, thesis_page
from pipelines.thesis.views import Runs

REASON = "no prediction in free run"


@pytest.fixture
def page(trees, tmp_path):
    """``page({"esea_dahl": Failed(...)}, only="emps")``: from the trees of the experiments named so."""

    def made(changed=None, only=""):
        outcomes = {k: v for k, v in {**trees, **(changed or {})}.items() if k.startswith(only)}
        experiments = {name: Settings(name.partition("_")[0], {}) for name in outcomes}
        captions = {figure.stem: REASON for chapter in CHAPTERS for figure in chapter.figures}
        seconds = {name: 12.3 for name, outcome in outcomes.items() if not isinstance(outcome, Failed)}
        return thesis_page(Runs(experiments, outcomes), captions, tmp_path / "figures", seconds)

    return made


def section(page, title):
    return next(one for one in page.sections if title in one.title)


def test_every_chapter_has_its_tables_and_says_what_its_data_are(page):
    made = page()
    assert [one.title for one in made.sections[1:]] == [f"Chapter {c.number}: {c.title}" for c in CHAPTERS]
    for chapter, shown in zip(CHAPTERS, made.sections[1:], strict=True):
        titles = [f"Table {table.number}: {table.title}" for table in chapter.tables]
        assert [table.caption for table in shown.tables] == titles
    assert "measured and simulated" in made.lead
    assert "a virtual rig repeats its experiment" in " ".join(section(made, "Chapter 5").paragraphs)
    assert section(made, "Chapter 6").paragraphs[0] == "Data: measured."


def test_a_chapter_that_nobody_asked_for_is_not_there(page):
    made = page(only="emps")
    assert [one.title[:9] for one in made.sections] == ["What was ", "Chapter 6"]
    assert "measured, as stated in each row" in made.lead


def test_what_was_run_names_what_failed_and_how_long_the_others_took(page):
    made = page({chapter5.FRICTIONS["Dahl"]: Failed("no memory left")}, only="esea")
    (table,) = section(made, "What was run").tables
    rows = {row[0]: row for row in table.rows}
    failed = rows.pop(chapter5.FRICTIONS["Dahl"])
    assert failed == (chapter5.FRICTIONS["Dahl"], "esea", "none, because no experiment has results", "",
                      "failed: no memory left")  # fmt: skip
    assert {row[1:] for row in rows.values()} == {("esea", "simulated", "12 s", "done")}


def test_figures_that_are_not_drawn_are_listed_with_the_reason(page, tmp_path):
    chapter = CHAPTERS[2]
    first, *others = [figure.stem for figure in chapter.figures]
    (tmp_path / "figures").mkdir()
    (tmp_path / f"figures/{first}.svg").write_text("<svg/>")
    shown = section(page(only="emps"), f"Chapter {chapter.number}")
    (picture,) = shown.pictures
    assert picture.path == tmp_path / f"figures/{first}.svg"
    assert picture.caption == f"{chapter.figures[0].title}. {REASON}"
    (missing,) = [line for line in shown.paragraphs if line.startswith("Figures not drawn")]
    assert missing.startswith(f"Figures not drawn ({REASON}): ")
    assert missing.count(", ") == len(others) - 1


def test_both_files_hold_the_numbers_and_the_errata(page, tmp_path):
    made = page()
    html = made.write(tmp_path)
    for text in (html.read_text(), html.with_suffix(".md").read_text()):
        for chapter in CHAPTERS:
            for table in chapter.tables:
                assert f"Table {table.number}: " in text
        assert "It is the RMSE in metres" in text
        assert "Nodes chosen without the validation record: 8" in text
        assert f"{list(chapter6.NODES)[-1]} nodes failed (a simulation diverges)" in text
