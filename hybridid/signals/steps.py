"""The steps that ``preprocess`` knows, read from plain mappings and applied in order.

``{step: butterworth, signals: [position], order: 4, cutoff: 50.0, zero_phase: true}``
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from hybridid.naming import unknown
from hybridid.plain import build
from hybridid.records.record import Record, RecordError
from hybridid.signals.butterworth import Butterworth
from hybridid.signals.calculus import Differentiate, Integrate, SavitzkyGolay
from hybridid.signals.decimate import Decimate
from hybridid.signals.masks import Keep, Mask
from hybridid.signals.simple import Crop, Offset, RemoveMean, Scale
from hybridid.signals.step import Step, StepError

STEPS: Mapping[str, type[Step]] = {
    "butterworth": Butterworth,
    "crop": Crop,
    "decimate": Decimate,
    "differentiate": Differentiate,
    "integrate": Integrate,
    "keep": Keep,
    "mask": Mask,
    "offset": Offset,
    "remove_mean": RemoveMean,
    "savitzky_golay": SavitzkyGolay,
    "scale": Scale,
}


def parse_step(values: Mapping[str, Any], where: str = "step") -> Step:
    """The step that a plain mapping describes: ``step`` gives its kind, the other keys its fields.

    Raises:
        StepError: in one line, with the nearest right name, for an unknown step or key, a
            missing key or an impossible value.
    """
    if not isinstance(values, Mapping) or "step" not in values:
        raise StepError(f"{where}: key 'step' is missing in {values!r}; allowed: {', '.join(STEPS)}")
    name = values["step"]
    if name not in STEPS:
        raise StepError(f"{where}: {unknown('step', name, STEPS)}")
    rest = {key: value for key, value in values.items() if key != "step"}
    return build(STEPS[name], rest, f"{where} ({name})", StepError)


def parse_steps(steps: Sequence[Mapping[str, Any]], where: str = "step") -> tuple[Step, ...]:
    """``parse_step`` of each mapping; error messages count the steps from 1."""
    return tuple(parse_step(values, f"{where} {i}") for i, values in enumerate(steps, start=1))


def apply_steps(record: Record, steps: Sequence[Step | Mapping[str, Any]]) -> Record:
    """``record`` after ``steps``, done in order.

    The record gets a warning if an output passed a causal filter and an input did not: the fit
    would take the filter's lag for dynamics of the machine.

    Raises:
        StepError: if a step is invalid or does not suit the record.
    """
    parsed = [s if isinstance(s, Step) else parse_step(s, f"step {i}") for i, s in enumerate(steps, start=1)]
    filters: dict[str, Counter[str]] = {channel.name: Counter() for channel in record.channels}
    for i, step in enumerate(parsed, start=1):
        try:
            record = step.apply(record)
        except (StepError, RecordError) as wrong:
            raise StepError(f"step {i} ({_name(step)}): {wrong}") from wrong
        _note(filters, step, record)
    lags = tuple(_lags(record, filters))
    return replace(record, warnings=(*record.warnings, *lags)) if lags else record


def _name(step: Step) -> str:
    return next((name for name, kind in STEPS.items() if type(step) is kind), type(step).__name__)


def _note(filters: dict[str, Counter[str]], step: Step, record: Record) -> None:
    """Note for each signal the causal filters that it passed; a new signal has those of its source."""
    if step.causal_filter:
        for name in step.touched:
            filters[name][step.causal_filter] += 1
    for channel in record.channels:
        if channel.name not in filters:
            filters[channel.name] = Counter(filters[step.touched[0]])


def _lags(record: Record, filters: Mapping[str, Counter[str]]) -> Iterator[str]:
    for output in record.output_channels:
        for channel in record.input_channels:
            for causal in filters[output.name] - filters[channel.name]:
                yield (
                    f"record {record.name}: output {output.name!r} passed a causal {causal}, input "
                    f"{channel.name!r} did not: the model will read the lag as dynamics; "
                    "filter both alike or set zero_phase"
                )
