"""A report as data, written twice: one self-contained HTML page and Markdown with the same content."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

STYLE = """
body{font:16px/1.5 system-ui,sans-serif;color:#222;max-width:60rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.6rem}h2{font-size:1.25rem;margin-top:2.5rem;border-bottom:1px solid #ddd}
table{border-collapse:collapse;margin:1rem 0;font-variant-numeric:tabular-nums}
caption{text-align:left;font-weight:600;padding:.3rem 0}
th,td{padding:.25rem .8rem;border-bottom:1px solid #e4e4e4;text-align:right}
th:first-child,td:first-child{text-align:left}thead th{border-bottom:2px solid #666}
.note{color:#666;font-size:.9rem;margin:.2rem 0}.lead{font-size:1.1rem}
figure{margin:1.5rem 0}figure img{max-width:100%}figcaption{color:#666;font-size:.9rem}
@media print{body{max-width:none;margin:0}figure,table{break-inside:avoid}}
"""


@dataclass(frozen=True)
class Table:
    """Rows of text under a header; the first column is the row's name."""

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Picture:
    """A figure's file (SVG or PNG) and its caption."""

    path: Path
    caption: str


@dataclass(frozen=True)
class Section:
    """A heading with paragraphs, then tables, then pictures."""

    title: str
    paragraphs: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()


@dataclass(frozen=True)
class Page:
    """A report: title, the one sentence that says it all, sections."""

    title: str
    lead: str
    sections: tuple[Section, ...]

    def html(self) -> str:
        """One HTML document with its pictures inside."""
        body = "".join(_section_html(section) for section in self.sections)
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8">'
            f"<title>{escape(self.title)}</title>"
            '<meta name="viewport" content="width=device-width,initial-scale=1">'
            f"<style>{STYLE}</style></head>"
            f'<body><h1>{escape(self.title)}</h1><p class="lead">{escape(self.lead)}</p>'
            f"{body}</body></html>\n"
        )

    def markdown(self, folder: Path) -> str:
        """The same as Markdown; pictures are linked relative to ``folder``."""
        parts = [f"# {self.title}", self.lead]
        for section in self.sections:
            parts += [f"## {section.title}", *section.paragraphs]
            parts += [_table_markdown(table) for table in section.tables]
            parts += [f"![{p.caption}]({_relative(p.path, folder)})" for p in section.pictures]
        return "\n\n".join(parts) + "\n"


def _section_html(section: Section) -> str:
    paragraphs = "".join(f"<p>{escape(text)}</p>" for text in section.paragraphs)
    tables = "".join(_table_html(table) for table in section.tables)
    pictures = "".join(_picture_html(picture) for picture in section.pictures)
    return f"<section><h2>{escape(section.title)}</h2>{paragraphs}{tables}{pictures}</section>"


def _table_html(table: Table) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in table.header)
    rows = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in table.rows
    )
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in table.notes)
    caption = f"<caption>{escape(table.caption)}</caption>"
    return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{notes}"


def _picture_html(picture: Picture) -> str:
    kind = "svg+xml" if picture.path.suffix == ".svg" else "png"
    data = base64.b64encode(picture.path.read_bytes()).decode()
    caption = escape(picture.caption)
    return (
        f'<figure><img alt="{caption}" src="data:image/{kind};base64,{data}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _table_markdown(table: Table) -> str:
    lines = [
        f"**{table.caption}**",
        "",
        _row(table.header),
        _row(["---", *["---:"] * (len(table.header) - 1)]),
    ]
    lines += [_row(row) for row in table.rows]
    lines += [f"\n*{note}*" for note in table.notes]
    return "\n".join(lines)


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _relative(path: Path, folder: Path) -> str:
    import os

    return Path(os.path.relpath(path, folder)).as_posix()
