"""Cells of a recording without a number: a sensor that dropped out for a moment.

They are refused, unless the signal is an output whose ``missing`` is ``mask``. Then they hold a value between
their neighbours, which no error is taken of.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, Protocol

import numpy as np

from hybridid.records.channel import Array, RecordError
from hybridid.records.masked import Counts

Missing = Literal["refuse", "mask"]


class _Mapped(Protocol):
    """What is asked of a signal here."""

    @property
    def name(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def missing(self) -> Missing: ...


class Gap(NamedTuple):
    """A signal (n,) with missing cells ``filled``, which cells they are (n,), and what is ``said`` of it."""

    filled: Array
    absent: Counts
    said: str = ""


def gap_of(record: str, signal: _Mapped, role: str, values: Array, time: Array) -> Gap:
    """The missing cells of ``values`` (n,) at ``time`` (n,), of a signal of ``role``, interpolated.

    Raises:
        RecordError: if cells are missing and the signal does not mask them, with the key that would; if an
            input or an auxiliary signal is to mask them; if all are missing.
    """
    where = f"record {record}: {role.removesuffix('s')} {signal.name!r}"
    absent = np.isnan(values)
    if signal.missing == "mask" and role != "outputs":
        raise RecordError(f"{where} has missing: mask, which only an output may have")
    if not absent.any():
        return Gap(values, absent)
    if absent.all():
        raise RecordError(f"{where} [{signal.unit}] is missing (NaN) at all samples")
    k = int(np.argmax(absent))
    share = f"{absent.sum()} of {len(values)} samples"
    if signal.missing != "mask":
        raise RecordError(
            f"{where} [{signal.unit}] is missing (NaN) at sample {k} (t = {time[k]:g} s), {share} are; "
            f"{_remedy(record, signal.name, role)}"
        )
    filled = np.where(absent, np.interp(time, time[~absent], values[~absent]), values)
    return Gap(filled, absent, f"{where} is missing at {share}, the first at t = {time[k]:g} s: masked")


def _remedy(record: str, name: str, role: str) -> str:
    if role == "outputs":
        return (
            f"set signals.outputs.{name}.missing=mask to leave them out "
            f"(records.{record}.outputs.{name}.missing where the record has outputs of its own)"
        )
    driving = ": what drives the model must be known throughout" if role == "inputs" else ""
    return f"repair them in the file{driving}"


def on_grid(grid: Array, time: Array, absent: Counts) -> Counts:
    """Which points (m,) of ``grid`` (m,) lie on or beside an ``absent`` cell (n,) of ``time`` (n,)."""
    if not absent.any():
        return np.zeros(len(grid), dtype=bool)
    beside: Counts = np.interp(grid, time, absent.astype(float)) > 0
    return beside
