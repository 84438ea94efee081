"""Whether outputs must count by their sensors' noise, since that of a poor one hides what a good one shows.

A loss divides the errors of each output by its standard deviation over the records. A poor sensor may then
make nearly all of it by its noise alone, and a fit leaves errors of a good sensor that are many times that
one's noise: they hardly count. So where, beside the declared model, noise makes most of the loss
(``Rules.majority``) and an output is more than ``Rules.far`` times its own noise from the record, the errors
of each output are divided by its sensor's noise instead. For white noise that is maximum likelihood. The
records must tell the noise of each output, and none may be declared.

Source: Ljung (1999), System Identification, 2nd ed., sec. 7.4.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hybridid.advice.unequal import DIGITS, noise_told
from hybridid.naming import listed
from hybridid.quantities import quantity
from hybridid.records.record import Record
from hybridid.trace.context import Context
from hybridid.trace.noise_floor.input_noise import NoiseLevel
from hybridid.trace.refits.refitted import Refit


def hidden_by_noise(base: Refit, context: Context) -> dict[str, NoiseLevel]:
    """The noise of each output by name, if the errors of ``base``, the declared model, must count by it; else
    none."""
    records, score, rules = context.split.records, base.score, context.rules
    told = noise_told(records)
    if not told:
        return {}
    noise = np.array(list(told.values()))
    of_noise = np.mean((np.minimum(noise, score.rmse) / score.scale) ** 2)
    if of_noise < rules.majority * score.loss**2 or not np.any(score.rmse > rules.far * noise):
        return {}
    return {c.name: NoiseLevel(told[c.name], c.unit) for c in records[0].output_channels}


def with_noise(records: Sequence[Record], levels: Mapping[str, NoiseLevel]) -> tuple[Record, ...]:
    """``records`` whose outputs have the noise ``levels`` declared."""
    return tuple(
        replace(
            record,
            output_channels=tuple(replace(c, noise=levels[c.name].value) for c in record.output_channels),
            warnings=(),
        )
        for record in records
    )


def weights_in_words(levels: Mapping[str, NoiseLevel]) -> str:
    """By what the errors of each output were divided; empty for their standard deviations."""
    if not levels:
        return ""
    each = listed([f"{quantity(one.value, one.unit, DIGITS)} of {name}" for name, one in levels.items()])
    return (
        f" Each output's errors count in multiples of its sensor's noise, as the records show it ({each}): "
        "over standard deviations, the noise of a poor sensor hides what a good one shows."
    )
