"""Outputs of sensors of very different quality, whose errors a fit counts alike.

By default each error is divided by its output's standard deviation. Divided by the noise of its sensor it is
maximum likelihood, and the good sensor decides what only it can tell.
Source: Ljung (1999), System Identification, 2nd ed., sec. 7.4.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from hybridid.advice.advice import Advice
from hybridid.estimators.problem import output_scale
from hybridid.quantities import number
from hybridid.records.record import Record
from hybridid.records.sensor_noise import sensor_noise

DIGITS = 2
"""Of a noise that the records show."""
UNEQUAL = 10.0
"""Ratio of the shares of noise of two outputs from which on weights matter: the errors of parameters may
become as many times smaller."""


def noise_told(records: Sequence[Record]) -> dict[str, float]:
    """The noise of each output of ``records``, by name in its unit; none where there is one output alone, a
    record does not tell it, or it is declared."""
    channels = records[0].output_channels
    found = [sensor_noise(record) for record in records]
    if len(channels) < 2 or any(c.noise for c in channels) or not all(n.told for own in found for n in own):
        return {}
    noise = np.sqrt(np.mean([[n.level**2 for n in own] for own in found], axis=0)).tolist()
    return {c.name: float(f"{level:.{DIGITS}g}") for c, level in zip(channels, noise, strict=True)}


def as_settings(noise: Mapping[str, float]) -> list[str]:
    """The ``noise`` of outputs as words of a command: ``+signals.outputs.speed.noise=0.15``."""
    return [f"+signals.outputs.{name}.noise={level:g}" for name, level in noise.items()]


def unequal_outputs(records: Sequence[Record]) -> Iterator[Advice]:
    """Which settings weigh each output of ``records`` by its noise, where these are very unequal."""
    noise = noise_told(records)
    if not noise:
        return
    share = dict(zip(noise, np.array(list(noise.values())) / output_scale(records), strict=True))
    best, worst = min(share, key=lambda name: share[name]), max(share, key=lambda name: share[name])
    if not share[worst] >= UNEQUAL * share[best] > 0:
        return
    times, settings = number(share[worst] / share[best], 2), " ".join(as_settings(noise))
    yield Advice(
        "weights",
        f"{best} is measured {times} times as well as {worst}, by noise over standard deviation, but a fit "
        f"counts their errors alike; {settings} weighs each by its noise, as the records show it",
    )
