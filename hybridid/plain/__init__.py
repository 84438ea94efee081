"""Between frozen dataclasses and plain data: dicts, lists, numbers and text, as in JSON and configs."""

from hybridid.plain.json_schema import schema
from hybridid.plain.restore import build, restored
from hybridid.plain.store import plain

__all__ = ["build", "plain", "restored", "schema"]
