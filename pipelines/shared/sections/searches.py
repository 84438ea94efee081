"""Sections of the commands that compare many models: trace, sweep and tune."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from hybridid.effects.variable import Variable
from hybridid.settings import inlined, setting
from hybridid.trace.rules import PAIRS, Rules

_CORES = "one a core"


@dataclass(frozen=True)
class TraceSection:
    """What is tried where, on which horizons, and by which rules."""

    horizon: Literal["auto"] | float = setting(
        "auto",
        "length of each horizon; auto: validate.horizon, longer where the fitted model has slower dynamics, "
        "or nothing drives the machine, shorter where the records would not give ten of them to judge by",
        unit="s",
        above=0,
        below=float("inf"),
    )
    records: tuple[str, ...] | None = setting(
        ("identification",),
        "roles or names of the records to fit",
        null="every record of the case",
        follows="fit.records",
    )
    held_out: Literal["auto"] | tuple[str, ...] | None = setting(
        "auto",
        "roles or names of the records that judge; auto: the validation records that are not fitted, "
        "or null if there are none",
        null="alternate horizons of the fitted records",
    )
    effects: tuple[str, ...] | None = setting(
        None, "ids of the effects to try (hybridid effects)", null="the whole library"
    )
    extra_effects: tuple[str, ...] = setting(
        (), "effects of your own, tried beside them", shown="[MODULE:NAME,...]"
    )
    leave_out: tuple[str, ...] = setting((), "ids of effects that are not tried", shown="[ID,...]")
    laws: bool = setting(
        True, "compose a law where no effect explains what a learned effort finds (docs/trace.md)"
    )
    pairs: int = setting(
        PAIRS,
        "pairs of effects that are tried where no single effect explains what is missing, the most promising "
        "ones; 0: none (docs/trace.md)",
        least=0,
    )
    revise: bool = setting(
        False, "leave out each declared effect in turn, and seek others in its place (as long again for each)"
    )
    by_recording: bool | None = setting(
        None,
        "true: try each parameter with a value for each record; only alternate horizons of two records or "
        "more can judge it (held_out: null); false: search on although values of its own for each would "
        "explain all",
        null="where these explain all, one effect is sought that does so alone, and no combination",
    )
    time_limit: float | None = setting(
        None,
        "no step begins that would end later, should it take as long as the one before; after it no effect, "
        "pair or law is tried, but the five effects that promise most",
        unit="s",
        above=0,
        null="no limit",
    )
    ports: tuple[str, ...] | None = setting(None, "names of the ports to try", null="all")
    variables: tuple[Variable, ...] | None = setting(
        None, "what learned efforts and laws may depend on", null="all that a port has"
    )
    rules: Rules = inlined(Rules())
    processes: int | None = setting(None, "trials side by side", least=1, null=_CORES)


@dataclass(frozen=True)
class SweepSection:
    """What a sweep does at each of its points, and how."""

    stage: Literal["auto", "trace"] = setting(
        "auto",
        "what is done at each point; auto: fit, train and score; trace: find what the model lacks, as "
        "hybridid trace -m does",
    )
    stack: int | None = setting(
        None,
        "points that train together at most; 1: every point is a job of its own",
        least=1,
        null="what the machine suggests",
    )
    processes: int | None = setting(None, "side by side on this machine", least=1, null=_CORES)
    job: str | None = setting(
        None, "file of one job, given by the sweep to the process that does it", shown="FILE", null="none"
    )


@dataclass(frozen=True)
class TuneSection:
    """What an adaptive search varies, and how long it goes on."""

    space: Mapping[str, Any] | None = setting(
        None,
        "config keys to vary, such as residual.width: {low: 1, high: 8}, with log: true or a step, or "
        "[a, b] to choose from; null: the key is not varied",
        shown="{...}",
        follows="conf/tune.yaml",
    )
    trials: int = setting(60, "in all, of every process, node and earlier command", least=1)
    seconds: float | None = setting(
        None, "after that time this command begins no trial", unit="s", above=0, null="no limit"
    )
    processes: int | None = setting(None, "trials side by side on this machine", least=1, null=_CORES)
    startup: int = setting(10, "random trials before the search adapts", least=1)
    pruner: Literal["median", "hyperband", "none"] = setting(
        "median",
        "which trials are ended early; median: those worse than the others at the same share of training",
    )
    seed: int = setting(0, "seed of the search", least=0, most=2**32 - 1)
