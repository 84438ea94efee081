"""A report as data, written twice: one self-contained HTML page and Markdown with the same content."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

STYLE = """
body{font:16px/1.5 system-ui,sans-serif;color:#222;max-width:60rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.6rem;margin-bottom:.4rem}h2{font-size:1.25rem;margin-top:2.5rem;border-bottom:1px solid #ddd}
table{border-collapse:collapse;margin:1rem 0;font-variant-numeric:tabular-nums;font-size:.92rem}
caption{text-align:left;font-weight:600;padding:.3rem 0}
th,td{padding:.25rem .8rem;border-bottom:1px solid #e4e4e4;text-align:right;vertical-align:top}
th.w,td.w{text-align:left}thead th{border-bottom:2px solid #666;vertical-align:bottom}
th:first-child,td:first-child{padding-left:0}td:not(.w){white-space:nowrap}
.note{color:#666;font-size:.9rem;margin:.2rem 0}.lead{font-size:1.1rem}
.mark{display:inline-block;border:1px solid #666;border-radius:.3rem;padding:0 .5rem;margin-right:.5rem;
font-size:.9rem;color:#444}
.scroll{overflow-x:auto}code{background:#f4f4f4;padding:.1rem .3rem;border-radius:.2rem}
pre{background:#f4f4f4;padding:.6rem .8rem;border-radius:.3rem;overflow-x:auto;font-size:.9rem}
nav{margin:1rem 0;padding:.5rem 0;border-top:1px solid #ddd;border-bottom:1px solid #ddd}a{color:#0072b2}
figure{margin:1.5rem 0}figure img{width:100%}figcaption{color:#666;font-size:.9rem}
@page{size:A4;margin:15mm}
@media print{body{max-width:none;margin:0;padding:0;font-size:10pt}figure,tr,pre{break-inside:avoid}
h2{break-after:avoid}thead{display:table-header-group}.scroll{overflow:visible}td,th{padding:.15rem .4rem}}
"""


@dataclass(frozen=True)
class Table:
    """Rows of text under a header. ``words`` are the columns that hold words, not numbers: the row's name."""

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    words: tuple[int, ...] = (0,)


@dataclass(frozen=True)
class Picture:
    """A figure's file (SVG or PNG) and its caption."""

    path: Path
    caption: str


@dataclass(frozen=True)
class Section:
    """A heading with paragraphs, then commands to type, tables, pictures."""

    title: str
    paragraphs: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    commands: tuple[str, ...] = ()


@dataclass(frozen=True)
class Page:
    """A report: title, ``marks`` (words such as ``measured``), the sentence that says it all, sections.

    ``contents`` puts links to the sections above them.
    """

    title: str
    lead: str
    sections: tuple[Section, ...]
    marks: tuple[str, ...] = ()
    contents: bool = False

    def html(self) -> str:
        """One HTML document with its pictures inside."""
        body = "".join(_section_html(section) for section in self.sections)
        links = " · ".join(f'<a href="#{_anchor(s)}">{escape(s.title)}</a>' for s in self.sections)
        body = f"<nav>{links}</nav>{body}" if self.contents else body
        marks = "".join(f'<span class="mark">{escape(mark)}</span>' for mark in self.marks)
        marks = f"<p>{marks}</p>" if marks else ""
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8">'
            f"<title>{escape(self.title)}</title>"
            '<meta name="viewport" content="width=device-width,initial-scale=1">'
            f"<style>{STYLE}</style></head>"
            f'<body><h1>{escape(self.title)}</h1>{marks}<p class="lead">{escape(self.lead)}</p>'
            f"{body}</body></html>\n"
        )

    def markdown(self, folder: Path) -> str:
        """The same as Markdown; pictures are linked relative to ``folder``."""
        parts = [f"# {self.title}", *([" · ".join(self.marks)] if self.marks else []), self.lead]
        if self.contents:
            parts.append(" · ".join(f"[{s.title}](#{_anchor(s)})" for s in self.sections))
        for section in self.sections:
            parts += [f"## {section.title}", *section.paragraphs]
            parts += [f"```\n{command}\n```" for command in section.commands]
            parts += [_table_markdown(table) for table in section.tables]
            parts += [f"![{p.caption}]({_relative(p.path, folder)})" for p in section.pictures]
        return "\n\n".join(parts) + "\n"


def _anchor(section: Section) -> str:
    """As Markdown's readers make it from a heading."""
    kept = "".join(c for c in section.title.lower() if c.isalnum() or c in " -")
    return kept.replace(" ", "-")


def _section_html(section: Section) -> str:
    paragraphs = "".join(f"<p>{escape(text)}</p>" for text in section.paragraphs)
    tables = "".join(_table_html(table) for table in section.tables)
    pictures = "".join(_picture_html(picture) for picture in section.pictures)
    commands = "".join(f"<pre>{escape(command)}</pre>" for command in section.commands)
    heading = f'<section id="{_anchor(section)}"><h2>{escape(section.title)}</h2>'
    return f"{heading}{paragraphs}{commands}{tables}{pictures}</section>"


def _table_html(table: Table) -> str:
    head = _cells("th", table.header, table.words)
    rows = "".join(f"<tr>{_cells('td', row, table.words)}</tr>" for row in table.rows)
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in table.notes)
    inside = f"<caption>{escape(table.caption)}</caption><thead><tr>{head}</tr></thead><tbody>{rows}</tbody>"
    return f'<div class="scroll"><table>{inside}</table></div>{notes}'


def _cells(tag: str, texts: Sequence[str], words: Sequence[int]) -> str:
    kinds = [' class="w"' if column in words else "" for column in range(len(texts))]
    return "".join(f"<{tag}{kind}>{escape(text)}</{tag}>" for kind, text in zip(kinds, texts, strict=True))


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
        _row(["---" if column in table.words else "---:" for column in range(len(table.header))]),
    ]
    lines += [_row(row) for row in table.rows]
    lines += [f"\n*{note}*" for note in table.notes]
    return "\n".join(lines)


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _relative(path: Path, folder: Path) -> str:
    import os

    return Path(os.path.relpath(path, folder)).as_posix()
