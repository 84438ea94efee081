"""What of a hidden law the records can show at all: the noncentrality, by the rig's own noise-free records.

    lambda = sum over outputs of (S_hidden - S_empty) / (sigma^2 + S_empty / n)

S_hidden is the held-out sum of squares (n samples) that the declared model leaves after it was refitted to
the noise-free records with the law at work, S_empty the same with nothing hidden: the error of the model's
own numerics. sigma is the sensor's noise. The noise is white and, as no controller reads it, the same motion
lies under any of its draws. So a player who knows the truth has held-out residuals e, and one who knows only
the declared model e + d, with sum(d^2) / sigma^2 = lambda. Their log-likelihood ratio is normal with the mean
lambda / 2 and the variance lambda, and its z is sqrt(lambda) / 2 on average:

    detectable:  p = Phi(-sqrt(lambda) / 2) < 0.001

This is the league's limit, in closed form. It needs no twin of the law and holds for laws that no CasADi
model can write. ``gain`` is what the truth takes from the held-out error (noise included).

Source: Kay (1998), Fundamentals of statistical signal processing II, ch. 4 (known signal in white noise).
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import norm

from benchmarks.drawn.amount import made, records_of
from benchmarks.drawn.draw import Draw
from benchmarks.drawn.machines import case_of
from benchmarks.league.machines import Declared
from benchmarks.league.ours import DETECTABLE
from hybridid.records.record import Record
from hybridid.trace.horizons.score import Score
from hybridid.trace.horizons.split import Split, by_record
from hybridid.trace.refits.declared_starts import regressed
from hybridid.trace.refits.refit import CONTINUATION, refit


@dataclass(frozen=True)
class Oracle:
    """``detectable``: whether the records can show what is hidden; False where nothing is. ``numerics``: the
    declared model's own error with nothing hidden, over the noise, of each output; ``left``: the same with
    the law at work. ``share`` is what the law takes of the drive's effort."""

    noncentrality: float
    p_value: float
    detectable: bool
    gain: float
    numerics: tuple[float, ...]
    left: tuple[float, ...]
    share: float
    hidden: tuple[dict, ...]
    seconds: float


def consult(draw: Draw) -> Oracle:
    """What the records of ``draw`` can show."""
    began = time.process_time()
    case = case_of(draw)
    empty = declared_score(case, records_of(draw, quiet=True, empty=True))
    hidden = made(draw.number)
    worked = declared_score(case, records_of(draw, quiet=True)) if hidden.hidden else empty
    return Oracle(
        **shown(empty, worked, draw.noise),
        share=hidden.share,
        hidden=tuple({"what": h.what, "port": h.port, "values": dict(h.values)} for h in hidden.hidden),
        seconds=time.process_time() - began,
    )


def shown(empty: Score, worked: Score, noise: float) -> dict[str, Any]:
    """What records show of a law, by the declared model's score on noise-free records without it and with it;
    ``noise`` is the sensor's standard deviation. The first six fields of ``Oracle``, by name."""
    samples = worked.samples.sum(axis=0)
    floor = noise**2 + empty.squares.sum(axis=0) / samples
    more = np.maximum(worked.squares.sum(axis=0) - empty.squares.sum(axis=0), 0.0)
    noncentrality = float((more / floor).sum())
    p_value = float(norm.sf(math.sqrt(noncentrality) / 2))
    before, after = (float(np.mean(x / worked.scale**2)) for x in (floor + more / samples, floor))
    return {
        "noncentrality": noncentrality,
        "p_value": p_value,
        "detectable": p_value < DETECTABLE,
        "gain": 1 - math.sqrt(after / before),
        "numerics": tuple((empty.rmse / noise).tolist()),
        "left": tuple((worked.rmse / noise).tolist()),
    }


def split_of(case: Declared, records: tuple[Record, Record]) -> Split:
    """Fitted on the first record, judged on the second."""
    return by_record(records[:1], records[1:], case.horizon)


def declared_score(case: Declared, records: tuple[Record, Record]) -> Score:
    """The declared model, refitted from the regression and from the true values."""
    model, split = case.model(), split_of(case, records)
    return refit(model, split, [regressed(model, split), case.truth], factors=CONTINUATION).score
