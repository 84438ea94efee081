"""The schemas and the page of the result files are those that the types give."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from hybridid.plain import schema

DOCS = Path(__file__).parents[1] / "docs"
WRITER = runpy.run_path(str(DOCS / "write_schemas.py"))
TEXTS = WRITER["texts"]()


@pytest.mark.parametrize("name", TEXTS)
def test_the_committed_file_is_up_to_date(name):
    assert (DOCS / name).read_text(encoding="utf-8") == TEXTS[name], "make schemas"


def test_no_other_schema_lies_there():
    assert {f"schemas/{path.name}" for path in (DOCS / "schemas").iterdir()} == {
        name for name in TEXTS if name.endswith(".json")
    }


@pytest.mark.parametrize("file", WRITER["FILES"])
def test_it_is_a_schema(file):
    Draft202012Validator.check_schema(schema(WRITER["FILES"][file]))
