"""A report as data, written twice: one self-contained HTML page and Markdown with the same content.

How they look is in ``templates/page.html``, ``page.css`` and ``page.md``.
"""

from __future__ import annotations

import base64
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipelines.shared.tree import write_text

_TEMPLATES = Path(__file__).parent / "templates"
_IMAGE_TYPES = {".svg": "svg+xml", ".png": "png"}
_SEPARATOR = re.compile(r"(?<=[\w%]/)(?=\w)|(?<=[\w%][._*+])(?=[^\W\d])")
"""Where a long name may go on in the next line; never inside a number."""
_MARKDOWN = re.compile(r"[*`\\]|<(?=[a-zA-Z/!])")
"""What Markdown would take for emphasis, code or HTML."""


@dataclass(frozen=True)
class Table:
    """Rows of text under a header. ``words`` are the columns that hold words, not numbers: the row's name.
    A ``folded`` one shows its caption alone until it is opened.

    Raises:
        ValueError: if a row has more or fewer cells than the header.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    words: tuple[int, ...] = (0,)
    folded: bool = False

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.header):
                raise ValueError(f"table {self.caption!r}: {len(row)} cells under {len(self.header)} columns")


@dataclass(frozen=True)
class Picture:
    """A figure's file (SVG or PNG) and its caption."""

    path: Path
    caption: str

    @property
    def data_address(self) -> str:
        """The file itself as an address, so that the page needs no other file."""
        data = base64.b64encode(self.path.read_bytes()).decode()
        return f"data:image/{_IMAGE_TYPES[self.path.suffix]};base64,{data}"


@dataclass(frozen=True)
class Section:
    """A heading with paragraphs, then commands to type, tables, pictures."""

    title: str
    paragraphs: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    commands: tuple[str, ...] = ()

    @property
    def anchor(self) -> str:
        """As Markdown's readers make it from a heading."""
        kept = "".join(c for c in self.title.lower() if c.isalnum() or c in " -")
        return kept.replace(" ", "-")


@dataclass(frozen=True)
class Page:
    """A report: title, ``marks`` (words such as ``measured``), the sentence that says it all, ``points`` to
    bear in mind beside it, sections."""

    title: str
    lead: str
    sections: tuple[Section, ...]
    marks: tuple[str, ...] = ()
    points: tuple[str, ...] = ()

    @property
    def has_contents(self) -> bool:
        """Whether links to the sections stand above them."""
        return len(self.sections) > 1

    def html(self) -> str:
        """One HTML document with its pictures inside."""
        return _render("page.html", self)

    def markdown(self, folder: Path) -> str:
        """The same as Markdown; pictures are linked relative to ``folder``."""
        return _render("page.md", self, relative=lambda path: Path(os.path.relpath(path, folder)).as_posix())

    def write(self, folder: Path, name: str = "index") -> Path:
        """Write ``name.html`` and ``name.md`` into ``folder``; returns the path of the HTML page."""
        write_text(folder / f"{name}.md", self.markdown(folder))
        write_text(folder / f"{name}.html", self.html())
        return folder / f"{name}.html"


def _render(template: str, page: Page, **filters: Callable[..., Any]) -> str:
    own: dict[str, Callable[..., Any]] = {"text": _text, "cell": _cell, "pieces": _SEPARATOR.split, **filters}
    return rendered(_TEMPLATES / template, own, page=page)


def rendered(template: Path, filters: Mapping[str, Callable[..., Any]], **given: object) -> str:
    """The text of a template of Jinja with what it is ``given``; a name that it lacks is an error."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape

    environment = Environment(
        loader=FileSystemLoader(template.parent),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= filters
    return environment.get_template(template.name).render(**given).rstrip() + "\n"


def _text(text: str) -> str:
    """``text`` so that Markdown shows it as it is."""
    return _MARKDOWN.sub(r"\\\g<0>", " ".join(text.split()))


def _cell(text: str) -> str:
    return _text(text).replace("|", "\\|")
