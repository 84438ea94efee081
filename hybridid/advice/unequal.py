"""Outputs of sensors of very different quality, whose errors a fit counts alike.

By default each error is divided by its output's standard deviation. Divided by the noise of its sensor it is
maximum likelihood, and the good sensor decides what only it can tell.
Source: Ljung (1999), System Identification, 2nd ed., sec. 7.4.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from hybridid.advice.advice import Advice
from hybridid.estimators.problem import output_scale
from hybridid.quantities import number
from hybridid.records.record import Record
from hybridid.records.sensor_noise import sensor_noise

UNEQUAL = 10.0
"""Ratio of the shares of noise of two outputs from which on weights matter: the errors of parameters may
become as many times smaller."""


def unequal_outputs(records: Sequence[Record]) -> Iterator[Advice]:
    """Which settings weigh each output of ``records`` by its noise, where these are very unequal, all told by
    the records, and none declared."""
    channels = records[0].output_channels
    found = [sensor_noise(record) for record in records]
    if len(channels) < 2 or any(c.noise for c in channels) or not all(n.told for own in found for n in own):
        return
    noise = np.sqrt(np.mean([[n.level**2 for n in own] for own in found], axis=0))
    share = noise / output_scale(records)
    best, worst = int(np.argmin(share)), int(np.argmax(share))
    if not share[worst] >= UNEQUAL * share[best] > 0:
        return
    settings = " ".join(
        f"+signals.outputs.{c.name}.noise={value:.2g}" for c, value in zip(channels, noise, strict=True)
    )
    yield Advice(
        "weights",
        f"{channels[best].name} is measured {number(share[worst] / share[best], 2)} times as well as "
        f"{channels[worst].name}, by noise over standard deviation, but a fit counts their errors alike; "
        f"{settings} weighs each by its noise, as the records show it",
    )
