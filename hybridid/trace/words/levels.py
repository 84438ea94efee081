"""The error over horizons at each change of the model, from the declared to the last."""

from __future__ import annotations

from collections.abc import Iterator

from hybridid.trace.entries import Level
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.steps import Search, Step


def path_of(search: Search) -> tuple[Level, ...]:
    """The error over horizons from the declared model to the last, at each change."""
    return (level("declared model", search.first), *_changes(search))


def _changes(search: Search) -> Iterator[Level]:
    following = [*(step.base for step in search.steps[1:]), search.final]
    for step, after in zip(search.steps, following, strict=False):  # no step where the floor is met at once
        if step.accepted is not None:
            yield level(_change(step), after)


def _change(step: Step) -> str:
    added = " ".join(f"+ {one.name}" for one in step.taken)
    return ", ".join([added, *(f"− {name}" for name in step.dropped)])


def level(label: str, base: Refit) -> Level:
    """Held-out and fitted RMSE over horizons by output."""
    names = [y.name for y in base.model.outputs]
    return Level(
        label,
        dict(zip(names, base.score.rmse.tolist(), strict=True)),
        dict(zip(names, base.fitted_rmse.tolist(), strict=True)),
        base.score.loss,
    )
