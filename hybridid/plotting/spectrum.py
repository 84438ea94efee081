"""Figure: amplitude spectra of data, models and errors (Welch)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from scipy import signal

from hybridid.plotting.axes import Array, axis_label, draw, name_y, scale_for
from hybridid.plotting.legends import legend_on_top
from hybridid.plotting.looks import DATA, look
from hybridid.plotting.series import PlotError, Response, one_output
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, is_wide, new_figure, styled
from hybridid.quantities import per_root_hertz

SEGMENTS = 4  # segment lengths in a record; with half overlap they give 7 averages
LEAST_SAMPLES = 64
DECADES = 9.0  # decades shown below the largest amplitude
PER_DECADE = 40  # of the drawn frequencies; the power between two of them is averaged
Spectrum = tuple[Array, Array]


@styled
def spectrum_plot(responses: Sequence[Response], width: float = DOUBLE_COLUMN) -> Plot:
    """Amplitude spectral density of the output with the models, and with their errors.

    ``A(f) = sqrt(S(f))``, ``S`` Welch's one-sided power spectral density: Hann window,
    half-overlapping segments, each without its mean, averaged in bands of 1/40 decade. The
    jumps between horizons contribute to all frequencies, so use free runs here.
    Source: Welch (1967), "The use of fast Fourier transform for the estimation of power
    spectra", IEEE Trans. Audio Electroacoust. 15(2).

    Raises:
        PlotError: if there is no response, they show different things, or one is too short or not finite.
    """
    responses = [_longest_piece(r) for r in responses]
    whole = one_output(responses)
    data = amplitude_density(whole.time, whole.measured, whole.record)
    models = [amplitude_density(r.time, r.predicted, r.model) for r in responses]
    errors = [amplitude_density(r.time, r.error, r.model) for r in responses]
    scale = scale_for("amplitude density", per_root_hertz(whole.unit), data[1])
    limits = _limits([data, *errors])
    wide = is_wide(width)
    figure = new_figure(width, 66 if wide else 112, f"{whole.title} spectrum", whole.provenance)
    panels = figure.subplots(*((1, 2) if wide else (2, 1)), sharex=True, sharey=True)
    for axes, title, spectra in zip(panels, ("output", "error"), (models, errors), strict=True):
        handles = [draw(axes, data[0], data[1] * scale.factor, DATA, whole.provenance)]
        for index, (response, (frequency, amplitude)) in enumerate(zip(responses, spectra, strict=True)):
            label = f"{response.model}, {response.view}"
            handles.append(draw(axes, frequency, amplitude * scale.factor, look(index), label))
        _dress(axes, data[0])
        axes.set_title(title)
        if axes is panels[0] or not wide:
            name_y(axes, scale)
        if axes is panels[-1] or wide:
            axes.set_xlabel(axis_label("frequency", "Hz"))
    legend_on_top(figure, handles)
    panels[0].set_ylim(limits[0] * scale.factor, limits[1] * scale.factor)
    return Plot(figure, "spectrum", _caption(whole, responses, data[0]), whole.provenance)


def _longest_piece(response: Response) -> Response:
    """The part of a masked ``response`` between two of its holes that has the most samples."""
    if not len(response.holes):
        return response
    edges = [0, *np.searchsorted(response.time, response.holes[:, 1]).tolist(), len(response.time)]
    first = int(np.argmax(np.diff(edges)))
    part = slice(edges[first], edges[first + 1])
    shown = {name: getattr(response, name)[part] for name in ("time", "measured", "predicted")}
    return replace(
        response, **shown, holes=np.empty((0, 2)), view=f"{response.view}, longest part without mask"
    )


def amplitude_density(time: Array, values: Array, of: str) -> Spectrum:
    """Frequencies in Hz without zero, and ``sqrt(S)`` there, both (m,), of ``values`` (n,) over ``time``.

    Raises:
        PlotError: if there are too few samples or one is not finite; ``of`` names the signal in the message.
    """
    n = len(values)
    if n < LEAST_SAMPLES:
        raise PlotError(f"spectrum of {of}: {n} samples, at least {LEAST_SAMPLES} are needed")
    if not np.isfinite(values).all():
        raise PlotError(f"spectrum of {of}: the response is not finite (the model diverged)")
    rate = (n - 1) / (time[-1] - time[0])
    length = max(LEAST_SAMPLES // 2, n // SEGMENTS)
    frequency, power = signal.welch(values, rate, window="hann", nperseg=length, detrend="constant")
    return _logarithmic(frequency[1:], power[1:])


def _logarithmic(frequency: Array, power: Array) -> Spectrum:
    """Mean power in bands of equal width on the logarithmic axis, as amplitudes.

    Low frequencies keep their single lines; at high frequencies, averaging removes the noise.
    """
    band = np.floor(PER_DECADE * np.log10(frequency / frequency[0]) + 0.5).astype(int)
    _, of, count = np.unique(band, return_inverse=True, return_counts=True)
    centre = np.bincount(of, weights=frequency) / count
    return centre, np.sqrt(np.bincount(of, weights=power) / count)


def _limits(spectra: Sequence[Spectrum]) -> tuple[float, float]:
    """All amplitudes, but no more than ``DECADES`` below the largest."""
    amplitudes = np.concatenate([amplitude for _, amplitude in spectra])
    amplitudes = amplitudes[amplitudes > 0]
    if not len(amplitudes):
        return 0.1, 10.0
    highest = float(amplitudes.max())
    return max(float(amplitudes.min()), highest * 10.0**-DECADES) / 2, highest * 2


def _dress(axes: Axes, frequency: Array) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(frequency[0], frequency[-1])
    axes.minorticks_off()
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")


def _caption(whole: Response, responses: Sequence[Response], frequency: Array) -> str:
    return (
        f"Amplitude spectral density of {whole.output} on {whole.record} ({whole.provenance}), of "
        f"{', '.join(f'{r.model} ({r.view})' for r in responses)} and of their errors, in "
        f"{per_root_hertz(whole.unit)} after Welch (Hann window, resolution {frequency[0]:.3g} Hz)."
    )
