"""Whether noise of a measured input makes the error that is left, even of a complete model.

A force, a torque or a current that a sensor measures is noisy. The model takes that noise for the input, and
errs by what it does to the motion. No effect of the machine explains this error. Nor is it the noise of an
output's sensor, so it looks like something that is missing.

With the noise n of an input in the records, the error is e^2 = r^2 + s^2, r from all other causes. Where as
much noise is added once more and all parameters are refitted, it is e'^2 = r^2 + 2 s^2. So each draw of the
added noise gives one value of s^2 = e'^2 - e^2. Noise may make all that is left beyond the floor of the
sensors and the simulation, if that is no more than the largest s^2 of ``DRAWS``: a Monte Carlo test, whose
p-value is then at least 2 / (DRAWS + 1).

The records say how much noise there may be (``hybridid.records.sensor_noise.input_noise``), not whether there
is any: a controller's command may carry as much, and is known exactly. Nor can there be so much that it alone
would leave more than is left: s^2 grows with the variance of n, so more than n e / s there is not.

Source: Cook, Stefanski (1994), Simulation-extrapolation estimation in parametric measurement error models,
J. Am. Stat. Assoc. 89(428), 1314-1328; Barnard (1963), J. R. Stat. Soc. B 25(2), 294 (Monte Carlo tests).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import Signal
from hybridid.records.channel import Channel
from hybridid.records.record import Record
from hybridid.records.sensor_noise import input_noise
from hybridid.trace.context import Context
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
DRAWS = 9
"""Of the noise that is added: a p-value of a fifth at least."""


@dataclass(frozen=True)
class NoiseLevel:
    """A standard deviation or an RMS error in ``unit``."""

    value: float
    unit: str


@dataclass(frozen=True)
class NoisyInputs:
    """By name, ``levels`` are the standard deviations of the white noise that each input has at most,
    ``leaves`` the RMS errors of each output that it makes, the mean over the draws."""

    levels: Mapping[str, NoiseLevel]
    leaves: Mapping[str, NoiseLevel]


def noisy_inputs(final: Refit, accuracy: Accuracy, context: Context) -> NoisyInputs | None:
    """The noise of the inputs that may make the held-out error of ``final`` beyond the floor; None where it
    may not, where no more than the floor is left, or where a fit with more noise has not converged: what that
    leaves too much would pass for noise.

    Outputs with no more than ``Rules.far`` times the floor are not asked, if others have more.
    """
    split, rules, left = context.split, context.rules, final.score.rmse**2
    times = accuracy.times(final.score.rmse)
    if times <= rules.near_floor:
        return None
    levels = [input_noise(record) for record in split.records]
    if not np.any(levels):
        return None
    noisier = [
        replace(split, records=tuple(map(_noisier, split.records, levels, generator.spawn(len(levels)))))
        for generator in np.random.default_rng(0).spawn(DRAWS)
    ]
    given = [(final.model, one, [final.values], final, final.numerics) for one in noisier]
    again = context.each("with more noise of the inputs", refit_if_possible, given)
    added = np.array([one.score.rmse**2 - left for one in again if one and one.converged])
    if len(added) < DRAWS:
        return None
    near = left <= (rules.far if times > rules.far else rules.near_floor) ** 2 * accuracy.squares
    if not (near | (left - accuracy.squares <= added.max(axis=0))).all():
        return None
    leaves = np.sqrt(np.maximum(added.mean(axis=0), 0.0))
    most = min(1.0, float(np.min(np.sqrt(left)[leaves > 0] / leaves[leaves > 0], initial=1.0)))
    return NoisyInputs(
        _named(split.records[0].input_channels, most * np.max(levels, axis=0)),
        _named(final.model.outputs, most * leaves),
    )


def _noisier(record: Record, levels: Array, generator: np.random.Generator) -> Record:
    """``record`` with white noise of ``levels`` (n_u,) added to its inputs."""
    return replace(record, inputs=record.inputs + levels * generator.standard_normal(record.inputs.shape))


def _named(signals: Sequence[Channel | Signal], values: Array) -> dict[str, NoiseLevel]:
    """The ``values`` (n,) of the ``signals`` by name, but those that are zero."""
    return {s.name: NoiseLevel(float(v), s.unit) for s, v in zip(signals, values, strict=True) if v > 0}
