"""The keys of each command, from the dataclasses that declare them: for the help and the completion."""

from __future__ import annotations

import textwrap
import typing
from collections.abc import Iterator
from typing import Any, Literal

from hybridid.settings import REQUIRED, Declared, Setting, declared
from hybridid.settings.bounds import options, words_of
from hybridid_cli.config_files import options as options_of
from pipelines.shared.sections.known import LONE, SECTIONS
from pipelines.shared.sections.stages import ReproduceKeys, UiKeys

WIDTH = 110
_COLUMN = 29
_OWN: dict[str, tuple[str, ...]] = {
    "preprocess": ("preprocess",),
    "fit": ("fit", "estimator"),
    "sweep": ("sweep",),
    "validate": ("validate", "controller"),
    "plot": ("plot",),
    "trace": ("trace",),
    "tune": ("tune",),
    "fetch": ("archive.url",),
    "log": ("mlflow.tracking_uri",),
    "ui": ("mlflow.tracking_uri",),
}
"""By command: sections, or single keys of some."""
_LONE = {"ui": UiKeys, "reproduce": ReproduceKeys}
_OWN_GROUPS = {"fit": "estimator", "residual": "residual", "sweep": "launcher"}
_GROUPS: dict[str, tuple[Any, Setting]] = {
    "case": ("emps", Setting("the machine and its records")),
    "experiment": (None, Setting("changes to a case, as the thesis' experiments need them", null="none")),
    "estimator": ("gauss_newton", Setting("how to fit; sets the keys of estimator")),
    "residual": (None, Setting("the network; sets the keys of residual", null="none")),
    "friction": ("linear", Setting("of case=esea: the friction that is declared")),
    "launcher": (
        "local",
        Setting(
            "what does the jobs of sweep and of -m; local: this process, for sweep one process a core; "
            "joblib: processes of this machine; slurm: a cluster"
        ),
    ),
}
"""Default and meaning of a config group: a key whose values are files of ``conf``."""
_HIDDEN = ("sweep.job", "residual.kind")


def of_command(command: str) -> str:
    """The keys of a command with their values, meaning and default; empty if it has none of its own."""
    own = [group(_OWN_GROUPS[command])] if command in _OWN_GROUPS else []
    own += declared(_LONE[command]) if command in _LONE else ()
    own += [one for key in _OWN.get(command, ()) for one in _chosen(key)]
    parts = [("Its own keys", own)]
    if command == "residual":
        from pipelines.shared.sections.residual import KINDS  # many keys, and no other help has them

        parts += [(f"Keys of residual={kind}", list(_below("residual", cls))) for kind, cls in KINDS.items()]
    return "\n".join(f"{title}\n{_table(found)}" for title, found in parts if found)


def group(name: str) -> Declared:
    """A config group as a key, with the files of ``conf`` as its values."""
    default, known = _GROUPS[name]
    return Declared(name, Literal[tuple(options_of(name))], default, known)


def groups() -> list[Declared]:
    """Every config group that a command line may choose from."""
    return [group(name) for name in _GROUPS]


def choices() -> dict[str, tuple[str, ...]]:
    """The words that may stand behind a key, by its dotted name."""
    from pipelines.shared.sections.residual import KINDS

    everything = [one for name, cls in SECTIONS.items() for one in _below(name, cls)]
    everything += [one for cls in KINDS.values() for one in _below("residual", cls)]
    everything += [one for cls in LONE for one in declared(cls)]
    null = {one.name: ("null",) * (type(None) in options(one.hint)) for one in everything}
    return {one.name: (*words_of(one.hint), *null[one.name]) for one in everything if words_of(one.hint)}


def value_of(one: Declared) -> str:
    """What stands for the value of a key, such as ``N``, ``auto|S`` or ``svg|pdf``."""
    given = options(one.hint)
    return one.setting.shown or "|".join(_shown(o, one.setting.unit) for o in given if o is not type(None))


def default_of(one: Declared) -> str:
    """The default as one would type it; empty if the key must be given."""
    if one.setting.follows:
        return one.setting.follows
    return "" if one.default is REQUIRED else typed(one.default)


def typed(value: Any) -> str:
    """A value as one would type it."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, tuple):
        return f"[{','.join(map(typed, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def meaning_of(one: Declared) -> str:
    """What a key means, and its unit."""
    first, semicolon, rest = one.setting.meaning.partition(";")
    unit = f", in {one.setting.unit}" if one.setting.unit else ""
    return f"{first}{unit}{semicolon}{rest}"


def _below(name: str, cls: type) -> Iterator[Declared]:
    for one in declared(cls, f"{name}."):
        if one.name not in _HIDDEN:
            yield one


def _chosen(key: str) -> Iterator[Declared]:
    section, dot, _ = key.partition(".")
    yield from (one for one in _below(section, SECTIONS[section]) if not dot or one.name == key)


def _shown(hint: Any, unit: str) -> str:
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if hint is bool or origin is Literal:
        return "|".join(words_of(hint))
    if origin is tuple:
        inner = _shown(options(arguments[0])[0], unit)
        return f"[{inner.replace('|', ',')}]" if words_of(arguments[0]) else f"[{inner},...]"
    return {int: "N", float: "S" if unit == "s" else "X", str: "NAME"}.get(hint, "{...}")


def _defaults(one: Declared) -> str:
    """The default, and what null stands for."""
    default, null = default_of(one), one.setting.null
    if default == "null" and null:
        return f"default: null, {null}"
    return "; ".join([f"null: {null}"] * bool(null) + [f"default: {default}"] * bool(default))


def _table(found: list[Declared]) -> str:
    lines = []
    for one in found:
        text = "; ".join(part for part in (meaning_of(one), _defaults(one)) if part)
        left = f"  {one.name}={value_of(one)}"
        indent = " " * _COLUMN
        wrapped = textwrap.wrap(text, WIDTH, initial_indent=indent, subsequent_indent=indent)
        if len(left) < _COLUMN:
            wrapped[0] = f"{left:<{_COLUMN}}{wrapped[0].strip()}"
        else:
            lines.append(left)
        lines += wrapped
    return "\n".join(lines) + "\n"
