"""The case file and the README of a new machine, as text."""

from __future__ import annotations

import json
from pathlib import Path

from pipelines.new.machine import Machine

_TEMPLATES = Path(__file__).parent / "templates"


def case_file(machine: Machine) -> str:
    """``case/NAME.yaml``."""
    return _rendered("case.yaml.j2", machine)


def readme(machine: Machine) -> str:
    """``README.md``."""
    return _rendered("README.md.j2", machine)


def _rendered(file: str, machine: Machine) -> str:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    quoted = environment.filters["quoted"] = lambda text: json.dumps(text, ensure_ascii=False)
    environment.filters["files"] = lambda files: quoted(files[0] if len(files) == 1 else files)
    environment.filters["span"] = lambda part: ", ".join(
        f"{key}: {at}" for key, at in (("start", part.start), ("stop", part.stop)) if at is not None
    )
    environment.filters["flow"] = lambda numbers: f"{{{', '.join(f'{k}: {v}' for k, v in numbers.items())}}}"
    return environment.get_template(file).render(machine=machine).rstrip() + "\n"
