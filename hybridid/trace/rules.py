"""``Rules``: what a verdict needs."""

from __future__ import annotations

from dataclasses import dataclass

from hybridid.settings import check, setting

PAIRS = 12
"""Of effects that are refitted after a stall, unless the user says otherwise."""


@dataclass(frozen=True)
class Rules:
    """What a verdict needs. A config gives those that are declared as settings.

    ``alpha``: the probability of one false effect among all that are tried in a step (Holm).
    ``worth``: the smallest decrease of the held-out RMSE worth having.
    ``tie``: the relative difference of RMSE below which two effects explain the record equally well.
    ``vague``: the standard error, as a share of the value, above which a parameter is not determined.
    ``collinear``: the correlation of two parameters above which the records cannot tell them apart, unless
    the standard error of the one in question is small all the same.
    ``steady``: the share of its value that an amplitude may move when the numerics change, or the records.
    ``kept``: the least share of its gain that an effect must keep when the numerics change.
    ``refuted``: how many times the error a change of the numerics may leave; above, the records refute it.
    ``near_floor``: how close to the noise floor, as a factor, the search ends.
    ``far``: how many times what noise and simulation alone leave is too much for ``nothing_missing``.
    ``majority``: the least share of the squared error that effects must take to be named where more than
    ``far`` is left; the least share that an effect must take of what a learned effort beside the same model
    takes; and the share of what is left that a free amplitude must take to show that it is no constant.
    ``stands_in``: the largest share of what an effect and a learned effort beside it take from the squared
    error that may be the learned effort's; above it, the trace tests whether the effect only stands in for
    something else.

    Raises:
        ValueError: if a setting is outside what is allowed.
    """

    alpha: float = setting(
        0.01, "probability of one false effect among all tried in a step", above=0, below=1
    )
    worth: float = setting(0.05, "smallest decrease of the held-out RMSE worth having", above=0, below=1)
    tie: float = setting(
        0.02,
        "relative difference of the RMSE below which two effects explain the record equally well",
        above=0,
        below=1,
    )
    vague: float = 0.5
    collinear: float = 0.999
    steady: float = 0.5
    kept: float = 0.5
    refuted: float = 1.5
    near_floor: float = 1.05
    majority: float = 0.5
    far: float = setting(
        3.0,
        "nothing is called missing up to this many times the error that noise and simulation alone leave",
        least=1,
    )
    stands_in: float = setting(
        0.1,
        "a learned effort beside an accepted effect may take at most this share of what both take from the "
        "squared error; above it, the effect may only stand in for something else",
        above=0,
        below=1,
    )
    most_effects: int = setting(6, "effects that may be accepted", least=1)

    def __post_init__(self) -> None:
        check(self, "trace")

    def passes(self, gain: float, p_value: float) -> bool:
        """Whether a held-out gain is worth having and significant."""
        return gain >= self.worth and p_value <= self.alpha
