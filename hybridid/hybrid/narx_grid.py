"""A grid of NARX networks on what a gray box leaves: trained, scored, and of each output the one to keep."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean
from typing import TYPE_CHECKING

import numpy as np

from hybridid.estimators.estimate import Progress
from hybridid.hybrid.gray_box import Errors, GrayBox, GrayRun, gray_scores, hybrid_scores
from hybridid.hybrid.output_error import OutputErrorHybrid
from hybridid.hybrid.report import FittedHybrid, NARXReport, NetworkScore
from hybridid.residuals.choice import RULE, chosen_network
from hybridid.residuals.demand import stack_of
from hybridid.residuals.settings import Architecture, Training

if TYPE_CHECKING:
    from hybridid.residuals.training import Task, Trained

Report = Callable[[str, Progress], None]
"""Is told which networks train, and how far; the fraction is of all."""


@dataclass(frozen=True)
class HeldOutError:
    """RMSE on the held-out blocks, mean over seeds, and ``without`` a network; in ``unit``."""

    held_out: float
    without: float
    unit: str


@dataclass(frozen=True)
class HeldOut:
    """How well networks of one size do, over outputs and seeds.

    ``share`` is the free-run RMSE on the held-out blocks over that of no network, root mean square over
    ``outputs`` and seeds; ``weights`` are those of one network of each output.
    """

    share: float
    weights: int
    outputs: Mapping[str, HeldOutError]


def networks_to_train(
    errors: Errors, architectures: Sequence[Architecture], outputs: Sequence[str], seeds: Sequence[int]
) -> list[Task]:
    """Every architecture for every output from every seed, size after size."""
    from hybridid.residuals.training import Task  # torch takes seconds to import

    return [Task(errors[name], one, seed) for one in architectures for name in outputs for seed in seeds]


def train_networks(tasks: Sequence[Task], training: Training, report: Report | None = None) -> list[Trained]:
    """Every network of ``tasks``: small ones in one stack, each larger size in one of its own."""
    from hybridid.residuals.training import train_stack  # torch takes seconds to import

    stacks: dict[tuple[int, int] | None, list[int]] = {}
    for number, task in enumerate(tasks):
        stacks.setdefault(stack_of(task.architecture), []).append(number)
    trained: dict[int, Trained] = {}
    for count, (size, numbers) in enumerate(stacks.items()):
        together = "one by one" if training.optimiser == "lbfgs" else "side by side"
        name = f"{len(numbers)} networks " + (f"of {size[0]} x {size[1]}" if size else together)
        tell = None if report is None else _part(report, name, count, len(stacks))
        found = train_stack([tasks[k] for k in numbers], training, tell)
        trained.update(zip(numbers, found, strict=True))
    return [trained[k] for k in range(len(tasks))]


def narx_hybrid(
    gray: GrayBox, runs: Sequence[GrayRun], trained: Sequence[Trained], seconds: float
) -> FittedHybrid:
    """The hybrid of the networks to keep of ``trained``, one for each output, and the scores of all.

    Where the rule prefers no network, the output keeps the gray box: its network has no members.

    ``runs`` are the gray box' on every record, ``seconds`` what the training took.

    Raises:
        ValueError: if every network of an output diverged on the held-out blocks.
    """
    outputs = list(dict.fromkeys(one.network.output for one in trained))
    own = {o: [one for one in trained if one.network.output == o] for o in outputs}
    best = {o: chosen_network(own[o]) for o in outputs}
    networks = (best[o] or replace(own[o][0], network=own[o][0].network.silent()) for o in outputs)
    hybrid = OutputErrorHybrid(gray.model, gray.estimate.values, tuple(one.network for one in networks))
    rows = tuple(_row(one, one is best[one.network.output], gray, runs) for one in trained)
    history = {output: one.history for output, one in best.items() if one}
    report = NARXReport(rows, gray_scores(gray, runs, outputs), RULE, history, seconds)
    useless = [_useless(own[o]) for o in outputs if best[o] is None]
    lost = [one.remark for row in rows if row.chosen for one in row.hybrid if one.remark]
    return FittedHybrid(hybrid, report, (*useless, *lost))


def _useless(trained: Sequence[Trained]) -> str:
    lowest = min(trained, key=lambda one: one.held_out)
    return (
        f"no network for the error of {lowest.network.output} is better than no correction: running free, "
        f"the best leaves {lowest.held_out:.3g} {lowest.unit} on the held-out blocks, without one they have "
        f"{lowest.zero:.3g} {lowest.unit}; this output keeps the gray box"
    )


def held_out_of(trained: Sequence[Trained]) -> HeldOut:
    """How well ``trained`` do: networks of one size, every output from the same seeds."""
    outputs = {
        name: HeldOutError(fmean(one.held_out for one in own), own[0].zero, own[0].unit)
        for name in dict.fromkeys(one.network.output for one in trained)
        for own in ([one for one in trained if one.network.output == name],)
    }
    shares = [one.held_out / one.zero for one in trained]
    seeds = len(trained) // len(outputs)
    weights = sum(one.network.count for one in trained) // seeds
    return HeldOut(float(np.sqrt(np.mean(np.square(shares)))), weights, outputs)


def _part(report: Report, name: str, number: int, stacks: int) -> Callable[[Progress], None]:
    """Reports one stack's training as a part of all."""
    return lambda one: report(name, replace(one, fraction=(number + (one.fraction or 0.0)) / stacks))


def _row(one: Trained, chosen: bool, gray: GrayBox, runs: Sequence[GrayRun]) -> NetworkScore:
    network = one.network
    return NetworkScore(
        output=network.output,
        depth=network.architecture.depth,
        width=network.architecture.width,
        seed=network.seed,
        weights=network.count,
        held_out=one.held_out,
        without=one.zero,
        unit=one.unit,
        stopped=one.stopped,
        chosen=chosen,
        hybrid=hybrid_scores(gray, runs, network),
        members=len(network.members),
    )
