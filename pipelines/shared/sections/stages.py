"""Sections of the stages from records to figures, and of what all commands share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from hybridid.plotting.looks import Kind
from hybridid.settings import REQUIRED, setting
from hybridid.settings.choices import InitialState, View

AllRecords = tuple[str, ...] | None
_RECORDS = "every record of the case"
_CORES = "one a core"
FEW_RECORDS = 4
"""Of so many records all are drawn."""


@dataclass(frozen=True)
class LoneKeys:
    """The keys that stand in no section."""

    model: str | None = setting(
        None,
        "model.json of fit or trace, in place of plant, effects and parameters",
        null="the case's own",
        shown="FILE",
        some=True,
    )
    out: str | None = setting(
        None,
        "folder for the whole run tree, or for all that sweep or tune writes",
        null="<paths.outputs>/<case>/<hash of the config>, of sweep <paths.outputs>/sweeps/<name>-<digest>, "
        "of tune <paths.outputs>/<case>/tune-<digest>",
        shown="DIR",
        some=True,
    )
    data: Literal["auto", "measured", "simulated"] = setting(
        "auto", "auto: measured records where they are found, else the case's virtual rig"
    )
    force: bool = setting(False, "make stages again whose results are fresh")


@dataclass(frozen=True)
class UiKeys:
    """The key of ``hybridid ui`` alone."""

    port: int = setting(5000, "the page is at http://127.0.0.1:<port>", least=1, most=65535)


@dataclass(frozen=True)
class ReproduceKeys:
    """The keys of ``hybridid reproduce`` alone."""

    experiments: tuple[str, ...] = setting(REQUIRED, "files of conf/experiment, in order", some=True)
    processes: int | None = setting(None, "experiments side by side", least=1, null=_CORES)


@dataclass(frozen=True)
class CaseSection:
    """What the machine is."""

    title: str = setting("", "the machine in one line")
    source: str = setting("", "where it is described")


@dataclass(frozen=True)
class ArchiveSection:
    """The public records of a case."""

    name: str | None = setting(None, "the archive that hybridid fetch downloads", null="there is none")
    url: str | None = setting(None, "a mirror of the archive", null="the publisher's")


@dataclass(frozen=True)
class RigSection:
    """The virtual rig that stands in for records that are not at hand."""

    path: str = setting(
        REQUIRED, "import path of the rig, as in hybridid.rigs.emps:EMPSRig", shown="MODULE:NAME", some=True
    )
    seed: int | None = setting(0, "seed of the noise", least=0, most=2**63 - 1, null="0")
    duration: float | None = setting(
        None, "length of the simulated records", unit="s", above=0, null="as long as the measured ones"
    )
    truth: Any = setting(
        None, "numbers of the truth by name, as in {M: 96.0}; null: the rig's own", shown="{...}"
    )
    planted: Any = setting(
        None,
        "laws that act on the rig, as in [{law: stribeck, amplitude: 5.0, velocity: 0.01}]; null: the rig's "
        "own",
        shown="[...]",
    )


@dataclass(frozen=True)
class PreprocessSection:
    """What is done to every record after it is read."""

    steps: Any = setting(
        (),
        "what is done to each record, in order, as in [{step: decimate, factor: 10}]; steps: butterworth, "
        "crop, decimate, differentiate, integrate, keep, mask, offset, remove_mean, savitzky_golay, scale",
        shown="[...]",
    )


@dataclass(frozen=True)
class FitSection:
    """What the model is fitted to."""

    records: AllRecords = setting(("identification",), "roles or names of the records to fit", null=_RECORDS)


@dataclass(frozen=True)
class ValidateSection:
    """How the fitted model is scored."""

    records: AllRecords = setting(None, "roles or names of the records to validate on", null=_RECORDS)
    views: tuple[View, ...] = setting(
        ("free_run", "horizon", "loop"),
        "free_run: the whole record in one go; horizon: many short runs; loop: under the law of controller, "
        "left out where the case has none",
        some=True,
    )
    horizon: float = setting(
        1.0,
        "length of each short run, which starts from an estimated state of its own",
        unit="s",
        above=0,
        below=float("inf"),
    )
    initial_state: InitialState = setting("estimated", "the state in which the free run starts")
    lags: int = setting(200, "lags of the residual's correlations", unit="samples", least=1)


@dataclass(frozen=True)
class ControllerSection:
    """The control law that ran the machine, for the view loop of validate."""

    law: str = setting(
        REQUIRED,
        "emps_pd, or the import path of your own; controller=LAW is short for it alone",
        shown="MODULE:NAME",
        some=True,
    )
    parameters: Mapping[str, float] | None = setting(
        None, "numbers of its parameters by name, as in {kp: 160}", null="as the law has them", shown="{...}"
    )
    references: Mapping[str, str] | None = setting(
        None,
        "the signal of the records that is a reference of the law, by the law's name for it",
        null="the signal of that name",
        shown="{...}",
    )
    every: int | None = setting(
        None, "the law works at each n-th sample of the record", least=1, null="as the law has it"
    )
    delay: int | None = setting(
        None, "its command acts so much later", unit="samples", least=0, null="as the law has it"
    )
    tolerance: float = setting(
        0.05,
        "largest RMS difference between the recorded command and that of the law with the recorded outputs, "
        "over the RMS of the recorded command about its mean; above, the loop is not simulated",
        above=0,
        below=float("inf"),
    )


@dataclass(frozen=True)
class PlotSection:
    """How figures are drawn."""

    formats: tuple[Kind, ...] = setting(
        ("svg",), "files of each figure; all three take more than twice the time of svg", some=True
    )
    records: Literal["auto", "all"] | tuple[str, ...] = setting(
        "auto",
        f"roles or names of the records to draw, or all; auto: all of up to {FEW_RECORDS} records; of more "
        "the one with the largest validation error, and comparisons of the median and of the smallest",
        some=True,
    )


@dataclass(frozen=True)
class PathsSection:
    """Where files lie."""

    data: str | None = setting(
        None,
        "where measured records lie, and where fetch puts them",
        null="$HYBRIDID_DATA, else data/raw",
        shown="DIR",
        some=True,
    )
    outputs: str = setting("outputs", "where run trees are written", shown="DIR", some=True)


@dataclass(frozen=True)
class LimitsSection:
    """What a command may take; what needs more is refused before it begins."""

    memory: float | None = setting(
        None, "memory that the estimate may reach", unit="GB", above=0, null="what this machine has free"
    )
    hours: float = setting(12.0, "time that the estimate may reach; it is a lower bound", unit="h", above=0)


@dataclass(frozen=True)
class MLflowSection:
    """Whether and where runs are logged."""

    enabled: bool = setting(True, "log each command as a run")
    tracking_uri: str | None = setting(
        None,
        "the store or the server, as in http://HOST:PORT",
        null="sqlite:///<paths.outputs>/mlflow.db",
        shown="URI",
        some=True,
    )
    experiment: str | None = setting(
        None, "name of the experiment in MLflow", null="the case's name", some=True
    )
    patience: float = setting(
        30.0,
        "how long a tracking server may take for a run; then the run is kept for hybridid log",
        unit="s",
        least=0,
    )
