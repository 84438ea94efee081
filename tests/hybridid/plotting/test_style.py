"""Sizes, headings and files."""

from __future__ import annotations

import re

import matplotlib
import pytest
from PIL import Image

from hybridid.plotting.lettering import cut
from hybridid.plotting.style import Plot, context, new_figure, save


def plot_of(width: float = 88.0, title: str = "a record", provenance: str = "measured") -> Plot:
    with context():
        figure = new_figure(width, 50.0, title, provenance)
        figure.subplots().plot([0, 1], [0, 1])
    return Plot(figure, "line", "A line.", provenance)


@pytest.mark.parametrize("width", [88.0, 180.0])
def test_the_png_has_the_column_s_width_at_200_dpi(tmp_path, width):
    png = save(plot_of(width), tmp_path)[2]
    with Image.open(png) as image:
        assert image.width == pytest.approx(width / 25.4 * 200, abs=1)
        assert image.info["dpi"] == pytest.approx((200, 200), abs=0.1)


def test_files_carry_their_caption_and_provenance(tmp_path):
    svg, pdf, png = save(plot_of(provenance="simulated"), tmp_path, "other")
    assert svg.name == "other.svg"
    assert "A line. Data: simulated." in svg.read_text()
    assert b"A line. Data: simulated." in pdf.read_bytes()
    with Image.open(png) as image:
        assert image.info["Description"] == "A line. Data: simulated."
        assert image.info["Title"] == "other"


def test_equal_data_give_equal_bytes(tmp_path):
    first, second = save(plot_of(), tmp_path / "a"), save(plot_of(), tmp_path / "b")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


def test_a_failure_leaves_the_old_files_and_nothing_else(tmp_path, monkeypatch):
    paths = save(plot_of(), tmp_path)
    old = [path.read_bytes() for path in paths]
    broken = plot_of(title="another record")
    draw = broken.figure.savefig

    def fail_at_png(path, **kwargs):
        if path.suffix == ".png":
            raise OSError("disk full")
        draw(path, **kwargs)

    monkeypatch.setattr(broken.figure, "savefig", fail_at_png)
    with pytest.raises(OSError, match="disk full"):
        save(broken, tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(paths)
    assert [path.read_bytes() for path in paths] == old


def test_a_long_heading_is_cut_but_keeps_its_provenance():
    figure = plot_of(title=("a very long name " * 10).strip(), provenance="simulated").figure
    heading, mark = (
        figure.findobj(lambda a, g=gid: a.get_gid() == g)[0] for gid in ("heading", "provenance")
    )
    assert heading.get_text().endswith("name · simulated")
    assert "…" in heading.get_text()
    assert heading.get_window_extent().x1 < mark.get_window_extent().x0


def test_a_user_s_own_settings_do_not_reach_the_figure(tmp_path):
    plain = save(plot_of(), tmp_path / "plain")[0].read_bytes()
    with matplotlib.rc_context({"lines.linewidth": 9, "font.size": 20, "axes.facecolor": "black"}):
        assert save(plot_of(), tmp_path / "own")[0].read_bytes() == plain


def test_a_cut_keeps_both_ends():
    assert cut("viscous, number 12", 10) == "visco…r 12"
    assert cut("viscous", 7) == "viscous"
    assert all(len(cut("a longish name of something", n)) <= n for n in range(4, 27))


def test_only_the_kinds_asked_for_are_written(tmp_path):
    plot = Plot(new_figure(88, 40, "a", "measured"), "a", "A.")
    assert save(plot, tmp_path, kinds=("svg",)) == [tmp_path / "a.svg"]
    assert [path.name for path in tmp_path.iterdir()] == ["a.svg"]


def test_saving_keeps_the_figures_layout(tmp_path):
    plot = Plot(new_figure(88, 40, "a", "measured"), "a", "A.")
    engine = plot.figure.get_layout_engine()
    save(plot, tmp_path)
    assert plot.figure.get_layout_engine() is engine


def test_coordinates_of_an_svg_are_short_and_true(tmp_path):
    figure = new_figure(88, 40, "a", "measured")
    figure.subplots().plot([0, 1 / 3], [0, 2 / 3])
    text = save(Plot(figure, "a", "A."), tmp_path, kinds=("svg",))[0].read_text()
    paths = re.findall(r' d="([^"]*)"', text)
    assert paths
    assert not re.search(r"\.\d{3}", " ".join(paths))
    assert "scale(0.015625)" in text  # what is no coordinate stays whole
