"""``Rules``: what a verdict needs."""

from __future__ import annotations

from dataclasses import dataclass

from hybridid.settings import check, setting


@dataclass(frozen=True)
class Rules:
    """What a verdict needs.

    ``alpha`` bounds the probability of one false effect among all tried in a step (Holm);
    ``worth`` is the smallest decrease of held-out RMSE worth having; ``tie`` the relative
    difference of RMSE below which two effects explain the record equally well; ``vague``
    the standard error, as a share of the value, above which a parameter is not determined,
    and ``collinear`` the correlation with another parameter above which the two are one;
    ``steady`` the share of its value that a parameter may move when the numerics change, and
    ``kept`` the least share of what an effect explains that must outlive the change; ``refuted``
    how many times the error a change may leave before it counts as refuted by the records;
    ``near_floor`` how close to the noise floor nothing more can be found; ``stands_in`` the share of
    what an effect takes from the squared error, and a learned effort beyond it, that may be the learned
    effort's: above, the effect only stands in for something else. A config gives those that are declared
    as settings.

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
    stands_in: float = setting(
        0.1,
        "share of what an effect and a learned effort beside it take from the squared error that may "
        "be the learned effort's; above, the effect only stands in for something else",
        above=0,
        below=1,
    )
    most_effects: int = setting(6, "effects that may be accepted", least=1)

    def __post_init__(self) -> None:
        check(self, "trace")

    def passes(self, gain: float, p_value: float) -> bool:
        """Whether a held-out gain is worth having and significant."""
        return gain >= self.worth and p_value <= self.alpha
