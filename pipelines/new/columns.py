"""Which column of a recording is which signal of a template, in which unit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from hybridid.declarations import Signal
from hybridid.naming import nearest
from hybridid.records.channel import Hold
from hybridid.records.survey import ColumnFound, labelled, words_of
from hybridid.records.units import factor
from pipelines.new.template import Template
from pipelines.shared.errors import ConfigError

EXPLAINED = 2
"""Columns that cannot be read, of which a line says why."""
NONE = "none"
"""What is said in place of a column: the machine lacks the signal."""
Ask = Callable[[str, Sequence[str]], str | None]
"""Puts a question with its possible answers to the user; None where nobody is there to answer."""


_Found = dict[str, ColumnFound | None]
"""The column of each signal, None where the machine lacks it."""


@dataclass(frozen=True)
class Chosen:
    """A signal and its column: ``signal = scale · column``. ``told`` says how the scale is known: from the
    ``user``, from the unit in the ``header``, from ``nothing``: then the signal's own unit is assumed, or the
    signal is ``bare``, of unit 1, and takes the numbers as they were recorded.
    ``hold`` is the course of an input between its samples, None where nothing tells it. ``gaps``: it is an
    output, and a recording lacks some of its cells."""

    signal: Signal
    column: ColumnFound
    scale: float
    told: str
    hold: Hold | None = None
    gaps: bool = False


def chosen(
    template: Template,
    columns: Sequence[ColumnFound],
    given: Mapping[str, str],
    scales: Mapping[str, float],
    ask: Ask,
    unusable: Mapping[str, str],
) -> tuple[Chosen, ...]:
    """A column for each signal: the one ``given``, else the only one whose name says it, else the only one
    whose unit fits, else the only one that is left, else the one that the user answers. ``unusable`` says why
    further columns are none. A signal that is ``none``, where the template can do without it, is left out.

    Raises:
        ConfigError: if a signal has no column, or a unit that no factor turns into the signal's.
    """
    signals = (*template.inputs, *template.outputs)
    found = _given(template, columns, given, unusable)
    while len(found) < len(signals):
        _settle(template, columns, found)
        left = [signal for signal in signals if signal.name not in found]
        if left:
            free = [one for one in columns if one not in found.values()]
            found[left[0].name] = _answered(template, left, free, ask, unusable)
    every = ((signal, found[signal.name]) for signal in signals)
    pairs = [(signal, column) for signal, column in every if column is not None]
    for signal, column in pairs:
        _check_quantity(template, signal, column)
    _check_scales([pair for pair in pairs if pair[0].name not in scales])
    return tuple(_in_unit(signal, column, scales) for signal, column in pairs)


def _given(
    template: Template, columns: Sequence[ColumnFound], given: Mapping[str, str], unusable: Mapping[str, str]
) -> _Found:
    """The columns that the user named, by signal."""
    by_name = {column.name: column for column in columns}
    found: _Found = {}
    for signal, said in given.items():
        name = full_name(said, by_name)
        if name == NONE and name not in (*by_name, *unusable):
            _check_lack(template, signal, _listed(by_name, unusable))
            found[signal] = None
            continue
        if name in unusable:
            raise ConfigError(f"signal {signal}: column {name!r} cannot be a signal: {unusable[name]}")
        if name not in by_name:
            raise ConfigError(
                f"signal {signal}: there is no column {name!r}{nearest(name, by_name)}; "
                f"columns: {_listed(by_name, unusable)}"
            )
        taken = next((other for other, one in found.items() if one is not None and one.name == name), None)
        if taken is not None:
            raise ConfigError(f"column {name!r} is given for {taken} and {signal}: a column is one signal")
        found[signal] = by_name[name]
    return found


def _check_lack(template: Template, signal: str, listed: str) -> None:
    """Whether the template can do without a ``signal``."""
    able = template.about.without
    if signal not in able:
        others = f", only without {' or '.join(able)}" if able else ""
        needs = f"template {template.kind} cannot do without the signal{others}"
        raise ConfigError(f"signal {signal}: there is no column {NONE!r}, and {needs}; columns: {listed}")


def full_name(said: str, names: Iterable[str]) -> str:
    """The one of ``names`` that is ``said``, or is ``said`` with a unit, as ``angle [deg]`` is ``angle``;
    ``said`` itself if there is none, or several."""
    every = list(names)
    fits = [name for name in every if labelled(name).label == said]
    return fits[0] if said not in every and len(fits) == 1 else said


def _listed(names: Iterable[str], unusable: Mapping[str, str]) -> str:
    """Columns by name, and those that are none, the first ``EXPLAINED`` with the reason."""
    listed = ", ".join(names) or "none"
    bad = [f"{one} ({why})" if k < EXPLAINED else one for k, (one, why) in enumerate(unusable.items())]
    return f"{listed}; no numbers: {', '.join(bad)}" if bad else listed


def _settle(template: Template, columns: Sequence[ColumnFound], found: _Found) -> None:
    """Add to ``found`` what one rule after the other leaves no doubt about."""
    signals = (*template.inputs, *template.outputs)
    for rule in (_by_name(template), _by_unit, _last_one):
        for signal in signals:
            free = [one for one in columns if one not in found.values() and not one.constant]
            left = [one for one in signals if one.name not in found]
            fits = rule(signal, free, left) if signal in left else []
            if len(fits) == 1:
                found[signal.name] = fits[0]


_Rule = Callable[[Signal, Sequence[ColumnFound], Sequence[Signal]], list[ColumnFound]]


def _by_name(template: Template) -> _Rule:
    """Columns with the signal's name; without one, those with the first of its other names that any has."""

    def fitting(signal: Signal, free: Sequence[ColumnFound], left: Sequence[Signal]) -> list[ColumnFound]:
        fits = [one for one in free if _may_be(signal, one, signal in template.inputs)]
        for name in (signal.name, *template.about.signals[signal.name]):
            found = [one for one in fits if name.split("_") == list(words_of(one.label))]
            found = found or [one for one in fits if name in words_of(one.label)]
            if found:
                return found
        return []

    return fitting


def _by_unit(signal: Signal, free: Sequence[ColumnFound], left: Sequence[Signal]) -> list[ColumnFound]:
    """Columns whose header names a unit of the signal's quantity, where no other signal is of it."""
    if any(factor(other.unit, signal.unit) is not None for other in left if other != signal):
        return []
    return [column for column in free if column.unit and factor(column.unit, signal.unit) is not None]


def _last_one(signal: Signal, free: Sequence[ColumnFound], left: Sequence[Signal]) -> list[ColumnFound]:
    """What is left, where one signal and one column are."""
    return [column for column in free if len(left) == 1 and len(free) == 1]


def _may_be(signal: Signal, column: ColumnFound, driven: bool) -> bool:
    """Whether the unit in the header allows it. A drive's effort may be recorded as the current or voltage
    that makes it, and the user then gives the scale."""
    return not column.unit or driven or factor(column.unit, signal.unit) is not None


def _answered(
    template: Template,
    left: Sequence[Signal],
    free: Sequence[ColumnFound],
    ask: Ask,
    unusable: Mapping[str, str],
) -> ColumnFound | None:
    """The column that the user answers for the first of the signals that are ``left``, None for ``none``;
    where nobody answers, a line asks for all of them."""
    by_name, first = {column.name: column for column in free}, left[0]
    lacks = {one.name: template.lack_of(one) for one in left if one.name in template.about.without}
    question = f"Which column is {_described(first)} [{first.unit}]?"
    if first.name not in lacks or NONE in by_name:
        answer = ask(question, list(by_name))
    else:
        answer = ask(f"{question} {NONE.capitalize()}: {lacks[first.name]}.", [*by_name, NONE])
    if answer is not None:
        return by_name.get(answer)
    asked = "; which ".join(f"is {_described(signal)}" for signal in left)
    flags = " ".join(f"--signal {signal.name}=COLUMN" for signal in left)
    without = "".join(f", or, if {why}, --signal {name}={NONE}" for name, why in lacks.items())
    names = [f"{one.name} (constant in the first recording)" if one.constant else one.name for one in free]
    raise ConfigError(
        f"which column {asked}? Give {flags}{without}; columns left: {_listed(names, unusable)}"
    )


def _described(signal: Signal) -> str:
    """``force, the force of the drive``."""
    return f"{signal.name}, the {signal.meaning}"


def _check_quantity(template: Template, signal: Signal, column: ColumnFound) -> None:
    """Whether the column of an output is neither its signal's rate nor what the signal is the rate of."""
    apart = _steps_of_time(signal, column) if signal in template.outputs else ""
    if apart:
        raise ConfigError(
            f"{_units(signal, column)}: it is {apart}, and no scale makes one of the other; "
            "hybridid new lists what each template measures"
        )


def _check_scales(pairs: Sequence[tuple[Signal, ColumnFound]]) -> None:
    """Whether the unit of each column can be turned into that of its signal; one line asks for all scales
    that are missing."""
    missing = [(signal, column) for signal, column in pairs if _scale_of(signal, column) is None]
    if missing:
        where = ", and ".join(_units(*pair) for pair in missing)
        flags = ", and ".join(
            f"--scale {signal.name}=NUMBER, in {signal.unit} per {column.unit}" for signal, column in missing
        )
        raise ConfigError(f"{where}: give {flags}")


def _units(signal: Signal, column: ColumnFound) -> str:
    return f"signal {signal.name} is in {signal.unit}, column {column.name!r} in {column.unit}"


def _scale_of(signal: Signal, column: ColumnFound) -> float | None:
    """``signal = scale · column`` by their units; 1 where there is none to convert, None where none fits."""
    return factor(column.unit, signal.unit) if column.unit and signal.unit != "1" else 1.0


def _in_unit(signal: Signal, column: ColumnFound, scales: Mapping[str, float]) -> Chosen:
    if signal.name in scales:
        return Chosen(signal, column, scales[signal.name], "user")
    if not column.unit:
        return Chosen(signal, column, 1.0, "nothing")
    if signal.unit == "1":
        return Chosen(signal, column, 1.0, "bare")
    scale = _scale_of(signal, column)
    assert scale is not None  # checked before
    return Chosen(signal, column, scale, "header")


def _steps_of_time(signal: Signal, column: ColumnFound) -> str:
    """Whether the header says that a column is the rate of a signal, or the signal the rate of it."""
    if not column.unit or signal.unit == "1":
        return ""
    if factor(column.unit, f"({signal.unit})/s") is not None:
        return "its rate of change"
    return "what it is the rate of" if factor(f"({column.unit})/s", signal.unit) is not None else ""
