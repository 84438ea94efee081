"""A page holds what it was given, in HTML and in Markdown, and nothing of it is taken for markup."""

from __future__ import annotations

import base64
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from pipelines.shared.page import Page, Picture, Section, Table

SVG, PNG = b'<svg xmlns="http://www.w3.org/2000/svg"/>', b"\x89PNG\r\n"


class Outline(HTMLParser):
    """Which tags opened and closed, the attributes by tag, and the text inside each tag."""

    def __init__(self, html):
        super().__init__()
        self.open, self.unbalanced, self.attributes, self.texts = [], [], {}, {}
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        self.attributes.setdefault(tag, []).append(dict(attributes))
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.unbalanced.append(tag)

    def handle_data(self, data):
        if self.open:
            self.texts.setdefault(self.open[-1], []).append(data)


@pytest.fixture
def pictures(tmp_path):
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures/fall.svg").write_bytes(SVG)
    (tmp_path / "figures/grid.png").write_bytes(PNG)
    return tuple(Picture(tmp_path / "figures" / name, f"How {name}") for name in ("fall.svg", "grid.png"))


@pytest.fixture
def page(pictures):
    scores = Table(
        "Scores (measured)",
        ("record", "RMSE", "remark"),
        (("first", "0.585 mm", "a | b"), ("second", "diverges", "")),
        notes=("Intervals at 95 %.",),
        words=(0, 2),
    )
    sections = (
        Section("What was found", ("One effect.",), (scores,), pictures, ("hybridid run 'a=[1, 2]'",)),
        Section("Left, and why", ("Nothing.",)),
        Section("Rules"),
    )
    return Page("Trace of emps", "The model lacked one effect.", sections, ("effect found", "measured"))


def test_html_has_every_part_once_and_in_order(page):
    html = page.html()
    outline = Outline(html)
    assert (outline.open, outline.unbalanced) == ([], [])
    parts = (
        "<h1>Trace of emps</h1>",
        "effect found",
        "The model lacked one effect.",
        "One effect.",
        "hybridid run",
        "Scores (measured)",
        "0.585 mm",
        "Intervals at 95 %.",
        "How fall.svg",
        "Left, and why</h2>",
        "Nothing.",
    )
    places = [html.index(part) for part in parts]
    assert places == sorted(places)
    assert outline.texts["title"] == ["Trace of emps"]
    assert outline.attributes["html"] == [{"lang": "en"}]


def test_numbers_stand_right_and_words_left(page):
    outline = Outline(page.html())
    kinds = [cell.get("class") for cell in outline.attributes["th"]]
    assert kinds == ["words", None, "words"]
    assert [cell.get("class") for cell in outline.attributes["td"]] == 2 * kinds
    assert "| --- | ---: | --- |" in page.markdown(page.sections[0].pictures[0].path.parent)


def test_a_folded_table_shows_its_caption_until_it_is_opened(page, tmp_path):
    table = replace(page.sections[0].tables[0], folded=True)
    folded = Page("", "", (Section("a", tables=(table,)),))
    outline = Outline(folded.html())
    assert (outline.open, outline.unbalanced) == ([], [])
    assert outline.texts["summary"] == ["Scores (measured)"]
    assert "caption" not in outline.texts
    assert "<details><summary>Scores (measured)</summary>\n\n| record |" in folded.markdown(tmp_path)
    assert "| second | diverges |  |\n\n</details>\n\n*Intervals" in folded.markdown(tmp_path)


def test_long_names_go_on_in_the_next_line_and_numbers_do_not():
    name = "004/oscillator/following_friction/noise0.00034"
    table = Table("", ("residual.width", "RMSE"), ((name, "0.585 mm"),))
    html = Page("", "", (Section("a", tables=(table,)),)).html()
    assert "residual.<wbr>width" in html
    assert "004/<wbr>oscillator/<wbr>following_<wbr>friction/<wbr>noise0.00034" in html
    assert "0.585 mm" in html


def test_pictures_are_inside_the_html_and_need_no_other_file(page):
    html = page.html()
    for kind, content in (("svg+xml", SVG), ("png", PNG)):
        assert f"data:image/{kind};base64,{base64.b64encode(content).decode()}" in html
    outline = Outline(html)
    assert [image["alt"] for image in outline.attributes["img"]] == ["How fall.svg", "How grid.png"]
    assert not {"link", "script"} & set(outline.attributes)


def test_points_stand_one_by_one_under_the_lead(page, tmp_path):
    told = replace(page, points=("It may be <another>.", "Free runs say *nothing*."))
    assert Outline(told.html()).texts["li"] == ["It may be <another>.", "Free runs say *nothing*."]
    assert "li" not in Outline(page.html()).texts
    markdown = told.markdown(tmp_path)
    assert "The model lacked one effect.\n\n- It may be \\<another>.\n- Free runs" in markdown


def test_markdown_links_pictures_from_where_it_lies(page, tmp_path):
    assert "![How fall.svg](figures/fall.svg)" in page.markdown(tmp_path)
    assert "![How fall.svg](../figures/fall.svg)" in page.markdown(tmp_path / "pages")


def test_markdown_has_every_part(page, tmp_path):
    assert (
        page.markdown(tmp_path)
        == """# Trace of emps

effect found · measured

The model lacked one effect.

[What was found](#what-was-found) · [Left, and why](#left-and-why) · [Rules](#rules)

## What was found

One effect.

```
hybridid run 'a=[1, 2]'
```

**Scores (measured)**

| record | RMSE | remark |
| --- | ---: | --- |
| first | 0.585 mm | a \\| b |
| second | diverges |  |

*Intervals at 95 %.*

![How fall.svg](figures/fall.svg)

![How grid.png](figures/grid.png)

## Left, and why

Nothing.

## Rules
"""
    )


def test_contents_link_to_the_sections_of_a_page_that_has_several(page):
    found = Outline(page.html()).attributes
    anchors = ["what-was-found", "left-and-why", "rules"]
    assert [section["id"] for section in found["section"]] == anchors
    assert [link["href"] for link in found["a"]] == [f"#{anchor}" for anchor in anchors]
    short = replace(page, sections=page.sections[:1])
    assert "<nav>" not in short.html()
    assert "](#" not in short.markdown(page.sections[0].pictures[0].path.parent)


HOSTILE = """<b>x</b> & "quoted" 'single' <script>alert(1)</script>"""


@pytest.mark.parametrize(
    "made",
    [
        Page(HOSTILE, "", ()),
        Page("", HOSTILE, ()),
        Page("", "", (), (HOSTILE,)),
        Page("", "", (Section(HOSTILE), Section("b"), Section("c"))),
        Page("", "", (Section("a", (HOSTILE,)),)),
        Page("", "", (Section("a", commands=(HOSTILE,)),)),
        Page("", "", (Section("a", tables=(Table(HOSTILE, (), ()),)),)),
        Page("", "", (Section("a", tables=(Table(HOSTILE, (), (), folded=True),)),)),
        Page("", "", (Section("a", tables=(Table("", (HOSTILE,), ((HOSTILE,),), (HOSTILE,)),)),)),
    ],
)
def test_no_text_is_taken_for_html(made):
    outline = Outline(made.html())
    assert not {"b", "script"} & set(outline.attributes)
    assert "&lt;b&gt;x&lt;/b&gt; &amp; &#34;quoted&#34;" in made.html()


def test_a_caption_cannot_leave_its_attribute(pictures):
    page = Page("", "", (Section("a", pictures=(replace(pictures[0], caption=HOSTILE),)),))
    (image,) = Outline(page.html()).attributes["img"]
    assert image["alt"] == HOSTILE
    assert set(image) == {"alt", "src"}


def test_markdown_shows_text_as_it_is(tmp_path):
    section = Section("a", ("N*m/s*V, `code`, <b>bold</b>, p < 10⁻¹⁵, f_v_0",))
    shown = r"N\*m/s\*V, \`code\`, \<b>bold\</b>, p < 10⁻¹⁵, f_v_0"
    assert shown in Page("", "", (section,)).markdown(tmp_path)


def test_a_cell_stays_in_its_row_of_markdown(tmp_path):
    table = Table("", ("a", "b"), (("two\nlines", "x | y"),))
    assert r"| two lines | x \| y |" in Page("", "", (Section("a", tables=(table,)),)).markdown(tmp_path)


def test_a_row_that_does_not_fit_its_header_is_refused():
    with pytest.raises(ValueError, match="table 'Scores': 1 cells under 2 columns"):
        Table("Scores", ("a", "b"), (("x",),))


def test_both_files_are_written(page, tmp_path):
    path = page.write(tmp_path, "report")
    assert path == tmp_path / "report.html"
    assert path.read_text(encoding="utf-8") == page.html()
    assert (tmp_path / "report.md").read_text(encoding="utf-8") == page.markdown(tmp_path)
