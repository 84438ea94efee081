"""Figure: all signals of a record over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hybridid.plotting.axes import Array, draw, frame, name_y, scale_for, shade, time_scale
from hybridid.plotting.legends import legend_above
from hybridid.plotting.looks import BLUE, DASHED, DOTTED, INK, SKY, VERMILION, Look
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled
from hybridid.quantities import number, with_unit
from hybridid.records.record import Channel, Record

ALONE = Look(BLUE, width=0.8)
# Signals that share a panel often coincide (a position and its reference), so the first is a
# broad, light line under the thin, dark ones.
SHARED = (
    Look(SKY, width=2.0),
    Look(VERMILION, DASHED, width=0.8, above=4),
    Look(INK, DOTTED, width=0.8, above=5),
)
COMPARABLE = 10.0  # largest ratio of the spans of two signals in one panel
STEPS_VISIBLE = 400  # a held input is drawn as steps if they are visible


@dataclass(frozen=True)
class _Signal:
    role: str
    channel: Channel
    values: Array

    @property
    def span(self) -> float:
        return float(np.ptp(self.values))


@styled
def record_plot(record: Record, width: float = DOUBLE_COLUMN) -> Plot:
    """Inputs, outputs and auxiliary signals over time; signals that compare share a panel.

    An input that stands still has no panel: the first line says its value.
    """
    panels = _panels(record)
    title = " · ".join([record.name, *_standing(record)])
    figure = new_figure(width, 18 + 27 * len(panels), title, record.provenance)
    rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    time = time_scale(record.time)
    for index, (axes, signals) in enumerate(zip(rows, panels, strict=True)):
        name = signals[0].channel.name if len(signals) == 1 else _common(signals)
        scale = scale_for(name, signals[0].channel.unit, *(s.values for s in signals))
        for order, signal in enumerate(signals):
            held = signal.role == "input" and signal.channel.hold == "zoh" and record.n <= STEPS_VISIBLE
            draw(
                axes,
                record.time * time.factor,
                signal.values * scale.factor,
                ALONE if len(signals) == 1 else SHARED[order],
                f"{signal.channel.name.replace('_', ' ')} ({signal.role})",
                steps=held,
            )
        shade(axes, _masked(record), time.factor)
        name_y(axes, scale)
        axes.set_ylim(frame([s.values * scale.factor for s in signals]))
        legend_above(axes)
        if index == len(panels) - 1:
            axes.set_xlabel(time.label)
    rows[0].set_xlim(record.time[0] * time.factor, record.time[-1] * time.factor)
    figure.align_ylabels()
    return Plot(figure, "record", _caption(record), record.provenance)


def _panels(record: Record) -> list[list[_Signal]]:
    """The signals by panel: an auxiliary signal joins an output with the same unit and a similar span."""
    roles = [("input", record.input_channels, record.inputs)]
    roles.append(("output", record.output_channels, record.outputs))
    if record.auxiliary is not None:
        roles.append(("auxiliary", record.auxiliary_channels, record.auxiliary))
    panels: list[list[_Signal]] = []
    for role, channels, values in roles:
        for column, channel in enumerate(channels):
            if channel.constant or (role != "output" and _stands(values[:, column])):
                continue
            signal = _Signal(role, channel, values[:, column])
            home = next((p for p in panels if _belongs(signal, p)), None)
            if home is None:
                panels.append([signal])
            else:
                home.append(signal)
    return panels


def _stands(values: Array) -> bool:
    return not np.ptp(values) > 0


def _standing(record: Record) -> list[str]:
    """Name and value of each input and auxiliary signal that stands still."""
    driving = (*record.input_channels, *record.auxiliary_channels)
    rows = [(c, record.signal(c.name)) for c in driving if not c.constant]
    return [
        f"{c.name.replace('_', ' ')} {with_unit(number(float(values[0])), c.unit)}"
        for c, values in rows
        if _stands(values)
    ]


def _belongs(signal: _Signal, panel: list[_Signal]) -> bool:
    first = panel[0]
    if len(panel) >= len(SHARED) or signal.channel.unit != first.channel.unit:
        return False
    if (signal.role == "input") != (first.role == "input") or not signal.span or not first.span:
        return False
    return 1 / COMPARABLE <= signal.span / first.span <= COMPARABLE


def _common(signals: list[_Signal]) -> str:
    names = [s.channel.name for s in signals]
    return ", ".join(names) if sum(map(len, names)) < 22 else names[0]


def _masked(record: Record) -> Array:
    """Times of the first and last sample of each masked stretch, (h, 2)."""
    edges = [(record.time[one.first], record.time[one.end - 1]) for one in record.masked]
    return np.array(edges).reshape(-1, 2)


def _caption(record: Record) -> str:
    signals = [channel.name for channel in record.channels if not channel.constant]
    listed = ", ".join(name.replace("_", " ") for name in signals)
    masked = f"; {np.sum(~record.counts):,} of them masked (shaded)" if record.masked else ""
    if record.absent is not None:
        names = [channel.name.replace("_", " ") for channel in record.output_channels]
        holes = zip(names, record.absent.sum(axis=0).tolist(), strict=True)
        masked += "".join(f"; {name} missing at {n:,} (interpolated)" for name, n in holes if n)
    return (
        f"Record {record.name} ({record.provenance}): {listed}; {record.n:,} samples at "
        f"{1 / record.dt:g} Hz over {record.time[-1] - record.time[0]:.3g} s{masked}."
    )
