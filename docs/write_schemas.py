"""``make schemas``: ``docs/schemas/*.json`` and ``docs/results.md`` from the types of the result files."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from hybridid.plain import schema
from hybridid.validation import Agreement, Metrics
from pipelines.shared.fitted import DescribedModel, Fit
from pipelines.shared.hybrids import Residual
from pipelines.shared.predictions import Tested
from pipelines.shared.prepared import Prepared
from pipelines.shared.traced import TraceFile
from pipelines.sweep.fleet import Fleet
from pipelines.sweep.results import SweepResult
from pipelines.tune.findings import Search

FILES: Mapping[str, Any] = {
    "preprocess/records.json": tuple[Prepared, ...],
    "fit/estimate.json": Fit,
    "fit/model.json": DescribedModel,
    "validate/metrics.json": tuple[Metrics, ...],
    "validate/residuals.json": tuple[Tested, ...],
    "validate/law.json": tuple[Agreement, ...],
    "residual/residual.json": Residual,
    "trace/trace.json": TraceFile,
    "sweep.json": SweepResult,
    "fleet.json": Fleet,
    "tune.json": Search,
}
"""Each file of results, and the dataclass that is written into it."""
HEAD = """\
# Result files
What the JSON files of a run tree hold, key by key; SI units throughout. `make schemas` writes this page and
the JSON Schemas (draft 2020-12) below `docs/schemas` from the dataclasses that the stages write. A number
that is not finite is written as null. For a notebook, `pipelines.shared` has a reader of each file, such as
`fitted.fit_of(tree)`, `predictions.metric_rows(tree)` and `hybrids.residual_of(tree)`.
"""


def texts() -> dict[str, str]:
    """Every file to write, by its path below ``docs``."""
    schemas = {name: {"title": name, **schema(cls)} for name, cls in FILES.items()}
    found = {
        f"schemas/{Path(name).stem}.schema.json": json.dumps(one, indent=1, ensure_ascii=False) + "\n"
        for name, one in schemas.items()
    }
    lines = [line for name, one in schemas.items() for line in _file(name, one)]
    return {**found, "results.md": "\n".join([HEAD, *lines]).rstrip() + "\n"}


def _file(name: str, found: Mapping[str, Any]) -> Iterator[str]:
    """One file's part of the page: what it holds, then each dataclass below it."""
    yield f"## {name}\nSchema: [{Path(name).stem}](schemas/{Path(name).stem}.schema.json)\n"
    if found.get("type") == "array":
        yield f"A {_kind(found)}.\n"
    for form in found.get("anyOf", [found] if "properties" in found else []):
        yield from _object(form)
    for title, below in found.get("$defs", {}).items():
        yield f"### {title}\n"
        yield from _object(below)


def _object(found: Mapping[str, Any]) -> Iterator[str]:
    """What a dataclass holds; those that it holds by name follow."""
    yield f"{_markdown(found['description'])}\n"
    yield "| key | value |\n|---|---|"
    for key, one in found["properties"].items():
        said = f": {one['description']}" if "description" in one else ""
        yield f"| `{key}` | {_kind(one)}{said} |"
    yield ""
    for key, one in found["properties"].items():
        by_name = one.get("additionalProperties", {})
        if isinstance(by_name, dict) and "properties" in by_name:
            yield f"### {by_name['title']}, each below `{key}`\n"
            yield from _object(by_name)


def _kind(one: Mapping[str, Any]) -> str:
    """The kind of a value in words."""
    if "$ref" in one:
        return str(one["$ref"]).rpartition("/")[2]
    if "anyOf" in one:
        return " or ".join(_kind(option) for option in one["anyOf"])
    if "enum" in one:
        return " or ".join(f"`{value}`" for value in one["enum"])
    if "prefixItems" in one:
        return f"list ({', '.join(_kind(item) for item in one['prefixItems'])})"
    if "prefixItems" in one:
        return f"list ({', '.join(_kind(item) for item in one['prefixItems'])})"
    if one.get("type") == "array":
        return f"list of {_kind(one['items'])}" if "items" in one else "list"
    if one.get("type") == "object":
        inner = one.get("additionalProperties")
        return f"mapping to {inner.get('title') or _kind(inner)}" if inner else "mapping"
    names = one.get("type", "anything")
    return names if isinstance(names, str) else " or ".join(names)


def _markdown(text: str) -> str:
    """A docstring as paragraphs of Markdown."""
    return text.replace("``", "`")


def main() -> None:
    docs = Path(__file__).parent
    (docs / "schemas").mkdir(exist_ok=True)
    for name, text in texts().items():
        (docs / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
