"""Cells of a recording without a number: a sensor that dropped out for a moment.

They are refused, unless ``missing`` of the signal says otherwise. Of an output they may be masked: they then
hold a value between their neighbours, of which no error is taken. Of an auxiliary signal they may be
interpolated: a temperature that is logged less often than the rest changes slowly.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple, Protocol

import numpy as np

from hybridid.records.channel import Array, RecordError
from hybridid.records.masked import Counts, pieces

Missing = Literal["refuse", "mask", "interpolate"]
ALLOWED: Mapping[str, Missing] = {"outputs": "mask", "auxiliary": "interpolate"}
"""What may become of missing cells, by the role of the signal. What drives the model must be known."""


class _Mapped(Protocol):
    """What is asked of a signal here."""

    @property
    def name(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def missing(self) -> Missing: ...


class Gap(NamedTuple):
    """A signal (n,) with missing cells ``filled``, which cells do not count (n,), and what is ``said``."""

    filled: Array
    absent: Counts
    said: str = ""


def gap_of(record: str, signal: _Mapped, role: str, values: Array, time: Array) -> Gap:
    """The missing cells of ``values`` (n,) at ``time`` (n,), of a signal of ``role``, interpolated.

    Raises:
        RecordError: if cells are missing and the signal refuses them, with the key that would not; if
            ``missing`` is not allowed for its role; if all are missing.
    """
    where = f"record {record}: {role.removesuffix('s')} {signal.name!r}"
    absent = np.isnan(values)
    if signal.missing not in ("refuse", ALLOWED.get(role)):
        only = "an output" if signal.missing == "mask" else "an auxiliary signal"
        raise RecordError(f"{where} has missing: {signal.missing}, which only {only} may have")
    if not absent.any():
        return Gap(values, absent)
    if absent.all():
        raise RecordError(f"{where} [{signal.unit}] is missing (NaN) at all samples")
    k = int(np.argmax(absent))
    if signal.missing == "refuse":
        raise RecordError(
            f"{where} [{signal.unit}] is missing (NaN) at sample {k} (t = {time[k]:g} s), "
            f"{absent.sum()} of {len(values)} samples are; {_remedy(record, signal.name, role)}"
        )
    filled = np.where(absent, np.interp(time, time[~absent], values[~absent]), values)
    said = (
        f"{where} is missing at {absent.sum()} of the {len(values)} samples of its files, the first at "
        f"t = {time[k]:g} s"
    )
    if signal.missing == "mask":
        return Gap(filled, absent, f"{said}: masked")
    longest = max(time[min(end, len(time) - 1)] - time[max(first - 1, 0)] for first, end in pieces(absent))
    return Gap(filled, np.zeros_like(absent), f"{said}: interpolated, over {longest:.3g} s at most")


def _remedy(record: str, name: str, role: str) -> str:
    if role == "outputs":
        return (
            f"set signals.outputs.{name}.missing=mask to leave them out "
            f"(records.{record}.outputs.{name}.missing where the record has outputs of its own)"
        )
    if role == "auxiliary":
        return f"set signals.auxiliary.{name}.missing=interpolate to draw straight lines in their place"
    return "repair them in the file: what drives the model must be known throughout"


def on_grid(grid: Array, time: Array, absent: Counts) -> Counts:
    """Which points (m,) of ``grid`` (m,) lie on or beside an ``absent`` cell (n,) of ``time`` (n,)."""
    if not absent.any():
        return np.zeros(len(grid), dtype=bool)
    beside: Counts = np.interp(grid, time, absent.astype(float)) > 0
    return beside
