"""``plot`` writes the formats it is asked for, and says which there are."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pipelines.plot import stage
from pipelines.plot.choice import errors
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch):
    """The start of other processes takes as long as these few figures."""
    monkeypatch.setattr(stage, "core_count", lambda: 1)


def written(tree):
    """The formats of all figures, which are those of the one that is drawn; the others are empty files."""
    files = list((tree / "plot").iterdir())
    formats = {path.suffix for path in files}
    assert {path.suffix for path in files if path.stat().st_size} == formats
    return formats - {".json"}


def test_only_the_formats_asked_for_are_written(settings, data, heard, draw_only):
    draw_only("first.record")
    first = {"validate.views": ["free_run"], "plot.records": ["first"]}
    short = settings({**first, "plot.formats": ["svg"]})
    assert written(run_stages(short, "run", heard).tree) == {".svg"}
    heard.said.clear()
    more = settings({**first, "plot.formats": ["svg", "png"]})
    assert written(run_stages(more, "run", heard).tree) == {".svg", ".png"}
    assert sum("fresh, reused" in line for line in heard.said) == 3  # only the drawing was done again


def test_a_short_record_gets_the_figures_that_it_can_fill(settings, data, heard):
    for name in ("first.csv", "second.csv"):
        head, *samples = (data / name).read_text().splitlines()
        (data / name).write_text("\n".join([head, *samples[500:530]]) + "\n")  # in motion
    short = settings({"validate.views": ["free_run"], "plot.records": ["first"], "estimator.horizon": None})
    tree = run_stages(short, "run", heard).tree
    drawn = {path.name for path in (tree / "plot").glob("*.svg")}
    assert "first.position.comparison.svg" in drawn
    assert "first.position.spectrum.svg" not in drawn
    (line,) = (line for line in heard.warned if "first.position.spectrum" in line)
    assert line.endswith("30 samples, at least 64 are needed")


def drawn_records(tree):
    return {path.name.partition(".")[0] for path in (tree / "plot").glob("*.record.svg")}


@pytest.fixture
def many(settings, data):
    """``many(plot)``: a case of five records; each later one starts the same motion later, and is shorter."""
    head, *samples = (data / "second.csv").read_text().splitlines()
    records = {"first": {"files": "first.csv", "role": "identification", "run": "identification"}}
    for k in range(4):
        (data / f"late{k}.csv").write_text("\n".join([head, *samples[150 * k :]]) + "\n")
        records[f"late{k}"] = {"files": f"late{k}.csv", "role": "validation", "run": "validation"}
    quick = {"validate.views": ["free_run"], "records": records, "fit.records": ["first"]}
    return lambda **plot: settings({**quick, "plot": plot})


def test_of_many_records_the_worst_is_drawn_and_two_are_compared(many, heard, draw_only):
    draw_only("position.raincloud")
    tree = run_stages(many(), "run", heard).tree
    ordered = sorted(errors(tree).items(), key=lambda one: one[1])
    assert len(ordered) == 5
    best, median, worst = (ordered[k][0] for k in (0, 2, 4))
    assert drawn_records(tree) == {worst}
    compared = {path.name.partition(".")[0] for path in (tree / "plot").glob("*.comparison.svg")}
    assert compared == {best, median, worst}
    spread = (tree / "plot" / "position.raincloud.svg").read_text()
    about = spread[spread.index("<dc:description>") : spread.index("</dc:description>")]
    assert {name for name in errors(tree) if f"{name} (measured)" in about} == {best, median, worst}
    (line,) = (line for line in heard.said if line.startswith(f"plot: of 5 records all figures of {worst}"))
    assert f"the comparisons of {median} (median) and {best} (best)" in line
    assert "plot.records=all" in line


@pytest.mark.parametrize(
    ("wanted", "names"),
    [
        ("all", {"first", "late0", "late1", "late2", "late3"}),
        (["identification"], {"first"}),
        (["late[12]", "first"], {"first", "late1", "late2"}),
    ],
)
def test_the_records_asked_for_are_drawn(many, heard, draw_only, wanted, names):
    draw_only()
    assert drawn_records(run_stages(many(records=wanted), "run", heard).tree) == names
    assert not any("plot.records=all" in line for line in heard.said)


def test_a_record_that_does_not_exist_is_said_before_anything_is_done(many, heard):
    with pytest.raises(ConfigError, match=r"unknown record in plot\.records: 'lat1'"):
        run_stages(many(records=["lat1"]), "run", heard)
    assert heard.said == []


def test_side_by_side_or_one_by_one_the_files_are_the_same(settings, data, heard, monkeypatch):
    one = settings({"validate.views": ["free_run"], "plot": {"records": ["first"]}})
    found = []
    for processes in (1, 2):
        monkeypatch.setattr(stage, "core_count", lambda n=processes: n)
        folder = run_stages(replace(one, config={**one.config, "force": True}), "run", heard).tree / "plot"
        found.append({p.name: p.read_bytes() for p in folder.iterdir() if p.suffix != ".json"})
    assert found[0] == found[1]
    assert len(found[0]) > 5


@pytest.mark.parametrize(
    ("formats", "said"),
    [
        (["svgg"], "plot.formats[0] is 'svgg': did you mean 'svg'?"),
        ([], "plot.formats is []: give at least one of svg, pdf, png"),
        ("svgg", "plot.formats[0] is 'svgg': did you mean 'svg'?"),
    ],
)
def test_a_wrong_format_is_said_before_anything_is_done(settings, data, heard, formats, said):
    with pytest.raises(ConfigError, match=r"plot\.formats") as raised:
        run_stages(settings({"plot": {"formats": formats}}), "run", heard)
    assert said in str(raised.value)
    assert "svg" in str(raised.value)
    assert heard.said == []
