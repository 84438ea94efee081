"""The configuration reference is what its generator writes from the declared keys, and lists every key."""

from __future__ import annotations

import runpy
from pathlib import Path

from hybridid.settings import keys
from hybridid.signals.steps import STEPS
from hybridid_cli.config_files import groups
from hybridid_cli.keys import groups as declared_groups
from pipelines.shared.sections.known import SECTIONS

DOCS = Path(__file__).parents[1] / "docs"
WRITER = runpy.run_path(str(DOCS / "write_configuration.py"))


def test_the_page_is_up_to_date():
    assert (DOCS / WRITER["PAGE"]).read_text() == WRITER["text"](), "make configuration writes it anew"


def test_every_group_and_every_step_is_listed():
    page = (DOCS / WRITER["PAGE"]).read_text()
    assert {*groups()} - {"hydra", "paths"} == {one.name for one in declared_groups()}
    assert [name for name in groups() if name != "paths" and f"| `{name}` |" not in page] == []
    assert [name for name in STEPS if f"#### {name}\n" not in page] == []


def test_every_key_of_every_section_is_listed():
    page = (DOCS / WRITER["PAGE"]).read_text()
    assert [
        f"{n}.{k}" for n, cls in SECTIONS.items() for k in keys(cls) if f"| `{n}.{k}` |" not in page
    ] == []
