"""Radial basis functions inside a gray box' equations: candidates compared on held-out blocks, one kept."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from itertools import starmap

from hybridid.estimators.estimate import Progress
from hybridid.hybrid.gray_box import GrayBox
from hybridid.hybrid.port import PortHybrid
from hybridid.hybrid.report import CandidateScore, FittedHybrid, RBFReport
from hybridid.residuals.held_out import RULE, Candidate, Mapper, Scored, choose, compare
from hybridid.residuals.rbf_fit import fit_rbf, port_of


def rbf_hybrid(
    gray: GrayBox,
    candidates: Sequence[Candidate],
    folds: int = 4,
    judged: bool = False,
    mapper: Mapper = starmap,
    report: Callable[[Progress], None] | None = None,
) -> FittedHybrid:
    """Fit the best of ``candidates`` to all records.

    Several are compared on ``folds`` blocks of the records, each held out in turn; one alone only if it is
    to be ``judged``. ``mapper`` carries these fits out.

    Raises:
        ValueError: if every candidate fails, or there are too few samples for the blocks.
    """
    began = time.perf_counter()
    scored: list[Scored] = []
    if len(candidates) > 1 or judged:
        scored = compare(gray.model, gray.records, candidates, gray.estimate.settings, folds, mapper)
    best = choose(scored) if scored else None
    kept = best.candidate if best else candidates[0]
    found = fit_rbf(gray.model, gray.estimate.values, gray.records, kept.plan, kept.settings, report)
    hybrid = PortHybrid(
        gray=gray.model,
        values=found.estimate.values,
        network=found.network,
        port=port_of(gray.model, kept.plan),
        records=tuple(record.name for record in gray.records),
        learned_from=" and ".join(sorted({record.provenance for record in gray.records})),
    )
    units = tuple(signal.unit for signal in gray.model.outputs)
    said = RBFReport(
        nodes=kept.plan.nodes,
        horizon=kept.settings.horizon,
        physics=kept.plan.physics,
        candidates=tuple(_row(one, one is best, units) for one in scored),
        rule=RULE if scored else None,
        seconds=time.perf_counter() - began,
    )
    # the network's own parameters are not reported
    warnings = tuple(w for w in found.estimate.warnings if ".rbf." not in w)
    return FittedHybrid(hybrid, said, warnings, found.estimate)


def _row(one: Scored, chosen: bool, units: tuple[str, ...]) -> CandidateScore:
    return CandidateScore(
        nodes=one.candidate.plan.nodes,
        horizon=one.candidate.settings.horizon,
        rmse=tuple(map(float, one.rmse)),
        gray_rmse=tuple(map(float, one.gray_rmse)),
        units=units,
        score=one.score,
        standard_error=one.standard_error,
        failures=tuple(sorted({f.failure for f in one.folds if f.failure})),
        chosen=chosen,
    )
