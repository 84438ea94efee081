"""The times of delays and lags at the sampling of the records.

A delay or a lag on the path of a signal is seen if it is neither far shorter than a sample nor longer than
the record is lively. The numbers of the library are those for samples of 1 ms: a delay of at most 10 samples,
lags that start at 2 and 20 samples, a fastest pole of half a sample, a rate that takes 100 samples from zero
to the scale of the input. Records with longer samples get as many samples. With shorter ones the numbers
stay, in seconds.

Source: Ljung (1999), System Identification, 2nd ed., sec. 13.7 (choice of the sampling interval).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.library import EFFECTS

SAMPLE = 1e-3
"""Seconds: the sampling for which the library's times of signal paths are declared."""
PATHS = ("input", "output")
"""Kinds of the ports on which a time is that of a signal, and not of the mechanism."""


def sampled(effects: Iterable[Effect], dt: float) -> tuple[Effect, ...]:
    """``effects``, those of the library at signal paths with times for records of ``dt`` s a sample."""
    return tuple(_at(effect, dt / SAMPLE) if dt > SAMPLE else effect for effect in effects)


def _at(effect: Effect, times: float) -> Effect:
    if effect not in EFFECTS or effect.kind not in PATHS or not any(map(_is_time, effect.parameters)):
        return effect
    parameters = tuple(_longer(p, times) if _is_time(p) else p for p in effect.parameters)
    return replace(effect, parameters=parameters)


def _is_time(p: EffectParameter) -> bool:
    return p.dimension.time == 1


def _longer(p: EffectParameter, times: float) -> EffectParameter:
    starts = tuple(times * start for start in p.starts)
    return replace(p, guess=times * p.guess, lower=times * p.lower, upper=times * p.upper, starts=starts)
