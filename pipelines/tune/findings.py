"""What the trials found: a row each, and the one to keep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from hybridid.hybrid.narx_grid import HeldOutError
from hybridid.plain import restored
from hybridid.quantities import percent
from hybridid.residuals.choice import NEAR, smallest_within
from pipelines.tune.request import Value

if TYPE_CHECKING:
    from optuna import Study
    from optuna.trial import FrozenTrial

RULE = (
    f"the fewest weights whose held-out share is within {percent(NEAR - 1)} of the lowest; of equals the "
    "lowest; pruned trials take no part"
)
State = Literal["done", "pruned", "failed", "stopped", "running"]


@dataclass(frozen=True)
class Row:
    """A trial. ``share`` is the objective, ``remark`` why it has none; ``outputs`` are RMSE on the held-out
    blocks by output. Times in s."""

    number: int
    state: State
    values: Mapping[str, Value]
    share: float | None
    weights: int | None
    outputs: Mapping[str, HeldOutError]
    began: float
    seconds: float
    remark: str = ""
    last: tuple[int, float] | None = None

    @property
    def outcome(self) -> str:
        """In words."""
        if self.share is not None:
            return f"held-out share {self.share:.4g}, {self.weights} weights, {self.seconds:.1f} s"
        return f"{self.state} ({self.remark})" if self.remark else self.state


@dataclass(frozen=True, eq=False)
class Findings:
    """All trials; ``chosen`` None if none came to an end; how much each key mattered, if it can be told."""

    rows: tuple[Row, ...]
    chosen: Row | None
    importance: Mapping[str, float] = field(default_factory=dict)

    def of(self, *states: State) -> list[Row]:
        """The trials in any of these states."""
        return [row for row in self.rows if row.state in states]

    @property
    def best(self) -> list[Row]:
        """Those with a value, the lowest first."""
        return sorted(self.of("done"), key=lambda row: row.share or 0.0)


@dataclass(frozen=True)
class Search:
    """``tune.json``: the search for a ``case``, the number of the ``chosen`` trial, and all ``trials``.

    ``importance`` is the share of each config key in what tells better trials from the rest.
    """

    case: str
    provenance: str
    objective: str
    rule: str
    chosen: int | None
    importance: Mapping[str, float]
    trials: tuple[Row, ...]


def findings_of(study: Study) -> Findings:
    """What is known by now."""
    rows = tuple(row_of(trial) for trial in study.trials)
    done = [row for row in rows if row.state == "done"]
    return Findings(rows, chosen_of(done), _importance(study, len(done)))


def chosen_of(done: Sequence[Row]) -> Row | None:
    """By ``RULE``."""
    shares = [row.share for row in done if row.share is not None]
    if not shares:
        return None
    return done[smallest_within(shares, [row.weights or 0 for row in done], NEAR * min(shares))]


def row_of(trial: FrozenTrial) -> Row:
    """A trial of Optuna as a row."""
    from optuna.trial import TrialState

    known = trial.user_attrs
    states: dict[TrialState, State] = {TrialState.COMPLETE: "done", TrialState.PRUNED: "pruned"}
    state = states.get(trial.state, "running")
    if trial.state == TrialState.FAIL:
        state = "failed" if "error" in known else "stopped"
    began, ended = trial.datetime_start, trial.datetime_complete
    return Row(
        trial.number,
        state,
        dict(trial.params),
        trial.value if state == "done" else None,
        known.get("weights"),
        restored(dict[str, HeldOutError], known.get("outputs", {}), f"trial {trial.number}: outputs"),
        began.timestamp() if began else 0.0,
        (ended - began).total_seconds() if began and ended else 0.0,
        str(known.get("error") or known.get("pruned") or ("its process ended" if state == "stopped" else "")),
        max(trial.intermediate_values.items(), default=None),
    )


def said(values: Mapping[str, Value]) -> str:
    """``depth=3 width=16``."""
    return " ".join(f"{key.removeprefix('residual.')}={setting(value)}" for key, value in values.items())


def setting(value: Value) -> str:
    """A config value as text."""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def _importance(study: Study, done: int) -> dict[str, float]:
    """PED-ANOVA: which keys tell the better trials from the rest; needs no further package."""
    import warnings

    import optuna

    if done < 10:
        return {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        evaluator = optuna.importance.PedAnovaImportanceEvaluator()
        return dict(optuna.importance.get_param_importances(study, evaluator=evaluator))
