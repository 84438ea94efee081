"""``plot`` writes the formats it is asked for, and says which there are."""

from __future__ import annotations

import pytest

from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError


def written(tree):
    return {path.suffix for path in (tree / "plot").iterdir()} - {".json"}


def test_only_the_formats_asked_for_are_written(settings, data, heard):
    short = settings({"validate.views": ["free_run"], "plot": {"formats": ["svg"]}})
    assert written(run_stages(short, "run", heard).tree) == {".svg"}
    heard.said.clear()
    more = settings({"validate.views": ["free_run"], "plot": {"formats": ["svg", "png"]}})
    assert written(run_stages(more, "run", heard).tree) == {".svg", ".png"}
    assert sum("fresh, reused" in line for line in heard.said) == 3  # only the drawing was done again


def test_a_short_record_gets_the_figures_that_it_can_fill(settings, data, heard):
    for name in ("first.csv", "second.csv"):
        head, *samples = (data / name).read_text().splitlines()
        (data / name).write_text("\n".join([head, *samples[500:530]]) + "\n")  # in motion
    short = settings(
        {"validate.views": ["free_run"], "plot": {"formats": ["svg"]}, "estimator.horizon": None}
    )
    tree = run_stages(short, "run", heard).tree
    drawn = {path.name for path in (tree / "plot").glob("*.svg")}
    assert "first.position.comparison.svg" in drawn
    assert "first.position.spectrum.svg" not in drawn
    (line,) = (line for line in heard.warned if "first.position.spectrum" in line)
    assert line.endswith("30 samples, at least 64 are needed")


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
