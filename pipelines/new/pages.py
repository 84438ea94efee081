"""The case file and the README of a new machine, as text."""

from __future__ import annotations

import json
from pathlib import Path

from pipelines.new.machine import Machine, Part
from pipelines.shared.page import rendered

_TEMPLATES = Path(__file__).parent / "templates"


def text_of(file: str, machine: Machine) -> str:
    """The text of ``case.yaml`` or ``README.md``."""
    return rendered(_TEMPLATES / f"{file}.j2", _FILTERS, machine=machine)


def _quoted(text: object) -> str:
    return json.dumps(text, ensure_ascii=False)


def _span(part: Part) -> str:
    ends = (("start", part.start), ("stop", part.stop))
    return ", ".join(f"{key}: {at}" for key, at in ends if at is not None)


_FILTERS = {
    "quoted": _quoted,
    "files": lambda files: _quoted(files[0] if len(files) == 1 else files),
    "span": _span,
    "flow": lambda numbers: f"{{{', '.join(f'{k}: {v}' for k, v in numbers.items())}}}",
}
