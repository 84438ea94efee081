"""``Trace``: all that a trace found, as plain typed data, and the evidence that it stands on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from hybridid.estimators import Estimate
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.quantities import quantity
from hybridid.trace.doubts.settled import Ceilings
from hybridid.trace.entries import (
    AcceptedEffect,
    DifferingParameter,
    EstimatedValue,
    Floor,
    LearnedGain,
    Level,
    ReplacedEffect,
    StepTaken,
    TriedEffect,
    UsedRecord,
    Width,
)
from hybridid.trace.horizons.split import Split
from hybridid.trace.noise_floor.input_noise import NoiseLevel, NoisyInputs
from hybridid.trace.results.before_after import FITTED, HELD_OUT, FittedModel, ScoreRow
from hybridid.trace.results.completeness import Completeness, WithNetwork
from hybridid.trace.results.missing_efforts import Missing
from hybridid.trace.rules import Rules
from hybridid.trace.search.longer import Longer
from hybridid.trace.verdict import Conclusion, Verdict


@dataclass(frozen=True)
class Estimates:
    """Parameters of the declared and of the last model; the same where nothing was accepted."""

    before: Mapping[str, EstimatedValue]
    after: Mapping[str, EstimatedValue]


@dataclass(frozen=True)
class LearnedGains:
    """Gains of learned efforts beside the declared and the last model."""

    before: tuple[LearnedGain, ...]
    after: tuple[LearnedGain, ...]


@dataclass(frozen=True, eq=False)
class Evidence:
    """The models and series behind a ``Trace``, for figures and further work; not in ``trace.json``.

    ``models`` are the declared and, if anything was accepted, the augmented one; ``ceilings`` and
    ``networks`` are theirs.
    ``missing`` holds the efforts that each lacks by record and port; ``failures`` say in words which could
    not be estimated.
    """

    split: Split
    conclusion: Conclusion
    models: tuple[FittedModel, ...]
    ceilings: tuple[Ceilings, ...]
    networks: tuple[WithNetwork, ...]
    missing: Missing
    failures: tuple[str, ...]


@dataclass(frozen=True)
class Trace:
    """What the declared model lacks, with the evidence, before and after.

    ``verdict`` is one word, ``sentence`` says it in words, and ``cautions`` say, one by one, what speaks
    against taking it at its word. ``accepted`` and ``rejected`` hold every
    effect that was tried, ``before`` and ``after`` the scores of the declared and the last model on every
    record. ``declared`` and ``effects`` name the terms of these two models, ``estimates`` hold their
    parameters, ``ceilings`` the gains of learned efforts beside them, ``path`` the error at each change.
    ``remains`` names where structure is left that no effect explains, ``stopped`` says why the search ended,
    and ``withdrawn`` which effect that had passed was withdrawn in the end, and why, if one was.
    ``times`` is the held-out error over what the sensor's noise and the simulation alone would leave,
    ``times_fitted`` that of the fitted horizons, and ``refused`` the gain worth having that a test refused,
    where that leaves the verdict open. So does an error that is as large over horizons of ``steady`` s,
    or far above the noise over ``longer`` ones. So do horizons that are ``too_short`` where the records give
    no longer ones, and parameters so ``vague`` that they alone may err by what is left. ``noisy`` is the
    noise of the inputs that may make all the error that is left, where noise and simulation alone do not.
    ``weights`` are the outputs' noise by which their errors count, by name; none: by standard deviations.
    ``split`` says in words which of the ``horizons`` (numbers fitted and held out) of ``horizon`` s judged.
    ``idle`` names the declared effects of which the records show nothing, ``either`` those of which each
    alone may be zero, but not all. ``disagreement`` tells what differs between the recordings, if values of
    its own for each leave no more than all that was found, ``own_values`` the settings of a command that
    gives each its own. ``replacements`` is what explains more in the place of a declared one, if asked.
    ``by_recording`` holds the parameters tried with a value for each record, where that was asked; the last
    model has one value of each. ``narrowed`` are the smoothings of sign(v) that were made narrower, and
    ``finer`` how many times shorter the steps are than stability and smooth motion ask for. ``refused_laws``
    are the composed laws, of ``laws_formed``, that were tried beside the last model, none of which passed.
    ``in_place_of`` are the effects that were accepted first, and whose place a law has taken.
    ``time_limit`` [s] is the one that ended the search, if one did.
    ``evidence`` holds the models themselves; it is None in a trace that was read from a file.
    """

    provenance: str
    verdict: Verdict
    sentence: str
    accepted: tuple[AcceptedEffect, ...]
    rejected: tuple[TriedEffect, ...]
    before: tuple[ScoreRow, ...]
    after: tuple[ScoreRow, ...]
    noise_floor: Mapping[str, Floor]
    seconds: float
    declared: tuple[str, ...]
    effects: tuple[str, ...]
    estimates: Estimates
    path: tuple[Level, ...]
    ceilings: LearnedGains
    remains: tuple[str, ...]
    times: float
    times_fitted: float
    refused: str
    completeness: Completeness | None
    stopped: str
    withdrawn: str
    split: str
    horizon: float
    horizons: tuple[int, int]
    rules: Rules
    records: tuple[UsedRecord, ...]
    steps: tuple[StepTaken, ...]
    idle: tuple[str, ...] = ()
    either: tuple[str, ...] = ()
    disagreement: str = ""
    own_values: tuple[str, ...] = ()
    replacements: tuple[ReplacedEffect, ...] = ()
    by_recording: tuple[DifferingParameter, ...] = ()
    narrowed: tuple[Width, ...] = ()
    finer: int = 1
    refused_laws: tuple[TriedEffect, ...] = ()
    laws_formed: int = 0
    in_place_of: tuple[str, ...] = ()
    time_limit: float | None = None
    steady: float | None = None
    longer: Longer | None = None
    too_short: bool = False
    vague: bool = False
    noisy: NoisyInputs | None = None
    weights: Mapping[str, NoiseLevel] = field(default_factory=dict)
    cautions: tuple[str, ...] = ()
    evidence: Evidence | None = field(default=None, repr=False, compare=False, metadata={"stored": False})

    def __str__(self) -> str:
        """The sentence, a line for each caution, then one for each record, view and output: the error before
        and after."""
        rows = zip(self.before, self.after, strict=True)
        cautions = (f"- {caution}" for caution in self.cautions)
        return "\n".join([self.sentence, *cautions, *(_line(before, after) for before, after in rows)])

    @property
    def words(self) -> str:
        """The sentence and the cautions as one text."""
        return " ".join((self.sentence, *self.cautions))

    @property
    def model(self) -> Model:
        """The last model: the declared one with every accepted effect."""
        return self.shown.conclusion.model

    @property
    def estimate(self) -> Estimate:
        """The last model's parameters, refitted on all fitted records."""
        return self.shown.models[-1].estimate

    @property
    def shown(self) -> Evidence:
        """The evidence.

        Raises:
            ValueError: if the trace was read from a file, which holds none.
        """
        if self.evidence is None:
            raise ValueError("this trace was read from a file: its models are in the run tree, not in it")
        return self.evidence

    @property
    def fitted_records(self) -> tuple[str, ...]:
        """Names of the records that the models are fitted to."""
        return tuple(record.name for record in self.records if record.role == FITTED)

    @property
    def judged(self) -> str:
        """Which horizons judged, in words."""
        length = f"{self.horizon:g} s horizons"
        held_out = [record.name for record in self.records if record.role == HELD_OUT]
        if held_out:
            return f"{length} of {listed(held_out)}, held out"
        return f"alternate {length} of {listed(self.fitted_records)}, held out"


def _line(before: ScoreRow, after: ScoreRow) -> str:
    """An error before and after, in one line."""
    view = "free run" if before.horizon is None else f"horizon {before.horizon:.3g} s"
    errors = " -> ".join(quantity(one.rmse, one.unit) for one in (before, after))
    network = ", with a network" if before.network else ""
    what = f"{before.record} ({before.role}), {view}, {before.output}{network}"
    return f"{what}: RMSE {errors}, {before.provenance}"
