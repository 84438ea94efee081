"""The documentation's links lead somewhere, and what it shows of a notebook runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
FOLDERS = ("docs", "data", "outputs", "benchmarks")
PAGES = [*ROOT.glob("*.md"), *sorted(p for d in FOLDERS for p in (ROOT / d).glob("**/*.md"))]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path):
    links = re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", path.read_text())
    inside = [link for link in links if not re.match(r"[a-z]+:", link)]
    assert [link for link in inside if not (path.parent / link).exists()] == []


def test_concepts_run(blocks):
    space: dict[str, object] = {}
    for block in blocks("concepts.md"):
        exec(block, space)
    assert "carriage.asymmetric_viscous.df_v" in {p.name for p in space["better"].parameters}


def _metres(shown: str) -> float:
    number, unit = shown.split()
    return float(number) * {"mm": 1e-3, "µm": 1e-6, "nm": 1e-9}[unit]


def test_trace_runs_in_a_notebook(blocks, own_folder, capsys):
    """It prints the verdict with both errors, marked simulated, and touches no file. Here learned efforts
    over one variable alone are held against it."""
    (block,) = blocks("trace.md")
    tried = 'effects=["asymmetric_viscous"],'
    assert tried in block
    exec(block.replace(tried, f"{tried} variables=('velocity',),"), {})
    sentence, *rows = capsys.readouterr().out.splitlines()
    assert "asymmetric_viscous at carriage" in sentence
    assert len(rows) == 2 * 2 * 2  # records, views, with and without the network
    errors = [re.search(r"horizon 0.6 s, position: RMSE (\S+ .?m) -> (\S+ .?m), ", row) for row in rows]
    shown = [tuple(map(_metres, found.groups())) for found in errors if found]
    assert len(shown) == 2
    assert all(after < 0.1 * before for before, after in shown)
    assert all(row.endswith(", simulated") for row in rows)
    assert list(own_folder.iterdir()) == []
