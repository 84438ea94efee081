"""``make configuration``: ``docs/configuration.md`` from the dataclasses that declare the keys."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator
from math import isfinite
from pathlib import Path
from typing import Any

from hybridid.model.compose import ADJUSTABLE
from hybridid.records.mapping import RecordMap, SignalMap, TimeMap
from hybridid.settings import REQUIRED, Declared, declared
from hybridid.settings.bounds import bound, kind
from hybridid.settings.declare import hints_of
from hybridid.signals.steps import STEPS
from hybridid_cli.keys import default_of, groups, meaning_of, typed
from pipelines.shared.sections.known import SECTIONS
from pipelines.shared.sections.residual import KINDS
from pipelines.shared.sections.stages import LoneKeys, ReproduceKeys, UiKeys

PAGE = "configuration.md"
HEAD = """\
# Configuration
Every key of a config. `make configuration` writes this page from the dataclasses that check the keys.

A key is set on the command line, as in `hybridid fit estimator.horizon=1000`, or in a file of a case or an
experiment. A list may hold a single value: `trace.effects=dahl` is `trace.effects=[dahl]`. A whole number
may be written as 1e3. true and false are the only booleans: yes, no, on, off, 0 and 1 are refused.
`hybridid <command> --cfg job` prints the values that a command would use; a case may set defaults of its own.
"""
FREE = f"""\
## The case's own keys
These keys hold names that the case chooses.

- `plant`: import path of the machine, as in `hybridid.plants.emps:EMPS`.
- `effects`: list of effects at its ports, as in `[viscous, coulomb@carriage]`; `hybridid effects` lists them.
  An effect without a port stands at the plant's first port of its kind. `mymodule:MY_EFFECT` is your own.
- `channels`: auxiliary signals of the records that effects may see, by name with their units, as in
  `{{temperature: °C}}`. null: none.
- `controller`: the section below; `controller=LAW` is short for `controller={{law: LAW}}`, null: none.
- `parameters`: by the name of a parameter, {", ".join(f"`{key}`" for key in ADJUSTABLE)}, as in
  `parameters.M.lower=30`, or `parameters.carriage.viscous.f_v.guess=200` of an effect at a port. `fixed`: the
  value is known and is not estimated. null: as the plant or the effect has it. Several at once are
  `parameters={{M: {{lower: 30, upper: 150}}, carriage.viscous.f_v: {{guess: 200}}}}`. Those that it does not
  name stay as the case has them. `by`: the parameter is estimated for each record that is fitted
  (`parameters.M.by=record`), or for each group of records, as in
  `parameters.M.by={{light: [first, second], heavy: [third]}}`; null: one value for all.
- `records`: by the name of a record, `role` (identification or validation), `run` (of the virtual rig;
  default: the record's name), `steps` (of this record alone, before `preprocess.steps`), `parameters`
  (of the plant, known and given by every record, as in `parameters: {{J: 0.02}}`), and the keys of the first
  table below.
- `signals`: the same keys, for all records. They are checked even where a virtual rig stands in, and the rig
  must give the inputs and outputs that they declare.
"""
GROUPS = """\
## Groups
A group is a key that takes a whole file of `conf`: `estimator=multiple_shooting` sets what
`conf/estimator/multiple_shooting.yaml` holds. `--config-dir DIR` adds files of your own, such as
`DIR/case/mine.yaml`.
"""
STEPS_HEAD = """\
### A step (`preprocess.steps`, and `steps` of a record)
`step` names it; the other keys are its own. A signal that a step makes of a `signal` is added in `role` if
its `name` is new; with the old name it takes the old one's place. With `demote`, the old one becomes
auxiliary.
"""
TABLES = {
    "A record": RecordMap,
    "A signal (`inputs.NAME`, `outputs.NAME`, `auxiliary.NAME`)": SignalMap,
    "The time axis (`time`)": TimeMap,
}


def text() -> str:
    """The whole page."""
    parts = [HEAD, "## Keys that stand in no section\n", *_table(declared(LoneKeys))]
    parts += ["Of `hybridid ui`:\n", *_table(declared(UiKeys))]
    parts += ["Of `hybridid reproduce`:\n", *_table(declared(ReproduceKeys))]
    parts += [GROUPS, *_table(groups()), FREE]
    for title, cls in TABLES.items():
        parts += [f"### {title}\n", *_fields(cls)]
    for name, cls in SECTIONS.items():
        parts += [f"## {name}\n{_first_line(cls)}\n", *_table(declared(cls, f"{name}."))]
        if name == "preprocess":
            parts += [STEPS_HEAD, *(line for step, kind in STEPS.items() for line in _step(step, kind))]
    for name, cls in KINDS.items():
        parts += [f"## residual ({name})\n{_first_line(cls)}\n", *_table(declared(cls, "residual."))]
    return "\n".join(parts).rstrip() + "\n"


def _first_line(cls: type) -> str:
    return str(cls.__doc__).partition("\n")[0]


def _table(found: Iterable[Declared]) -> Iterator[str]:
    yield "| key | default | allowed | meaning |\n|---|---|---|---|"
    for one in found:
        null = f"; null: {one.setting.null}" if one.setting.null else ""
        default = "must be given" if one.default is REQUIRED else _code(default_of(one))
        yield f"| `{one.name}` | {default} | {_allowed(one)} | {_cell(meaning_of(one) + null)} |"
    yield ""


def _allowed(one: Declared) -> str:
    """The type in words, and the bounds."""
    known = one.setting
    bounds = (("≥", known.least), ("≤", known.most), (">", known.above), ("<", known.below))
    limits = [f"{sign} {bound(value)}" for sign, value in bounds if value is not None and isfinite(value)]
    words = "any" if one.hint is Any else kind(one.hint)
    return _cell(", ".join([words, *limits]))


def _fields(cls: type) -> Iterator[str]:
    """The keys of a dataclass that declares no settings."""
    yield f"{_paragraph(cls)}\n"
    yield "| key | default | type |\n|---|---|---|"
    for field in dataclasses.fields(cls):  # type: ignore[arg-type]
        hint = hints_of(cls)[field.name]
        missing = field.default is dataclasses.MISSING
        default = "must be given" if missing else _code(typed(field.default))
        yield f"| `{field.name}` | {default} | {_cell(kind(hint))} |"
    yield ""


def _step(name: str, cls: type) -> Iterator[str]:
    yield f"#### {name}\n"
    yield from _fields(cls)


def _paragraph(cls: type) -> str:
    """The docstring up to its list of errors, as one paragraph."""
    return " ".join(str(cls.__doc__).partition("Raises:")[0].replace("``", "`").split())


def _code(value: str) -> str:
    return f"`{value}`" if value else "empty"


def _cell(words: str) -> str:
    return words.replace("|", "\\|").replace("<", "&lt;")


if __name__ == "__main__":
    (Path(__file__).parent / PAGE).write_text(text(), encoding="utf-8")
