"""The entries of a ``Trace``: plain numbers and words, as ``trace.json`` holds them. SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from hybridid.declarations import PortKind
from hybridid.naming import as_entry
from hybridid.trace.trials.robustness import Survival


@dataclass(frozen=True)
class Value:
    """A parameter's value and standard error in ``unit``.

    ``std`` is nan where none was asked for, and where the 95 % interval would be wider than all that is
    allowed, or narrower than a billionth of the value.
    """

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class EstimatedValue:
    """A parameter of a refitted model, with its 95 % interval."""

    value: float
    std: float
    unit: str
    interval_95: tuple[float, float]
    at_bound: bool
    identifiable: bool
    meaning: str


@dataclass(frozen=True)
class TriedEffect:
    """An effect that was tried at a port, and what was decided.

    ``gain`` is the relative decrease of the held-out RMSE (-1: it could not be fitted), ``p_value`` the
    adjusted p-value in the ``step``; ``parameters`` are the effect's own. ``class_of`` names the accepted
    effect that it cannot be told from, if any. ``is_law``: a composed law, no effect of the library.
    ``more``, of a member of a class: the share of the held-out error that it leaves beyond what the accepted
    effect leaves, both in the last model (below 0: it leaves less).
    """

    effect: str
    port: str
    status: str
    reason: str
    step: int
    gain: float
    p_value: float
    parameters: Mapping[str, Value]
    seconds: float
    class_of: str | None = None
    is_law: bool = False
    more: float = 0.0

    @property
    def name(self) -> str:
        """``carriage.viscous``."""
        return f"{self.port}.{self.effect}"


@dataclass(frozen=True)
class AcceptedEffect:
    """An accepted effect with its evidence.

    ``parameters`` are its own in the last model, ``known`` those that are not estimated (the side of an end
    stop, the height that an overflow is told for), ``at_step`` their values when it was accepted. ``alike``
    are the ids of the effects that the records cannot tell apart, itself first; ``class_members`` their
    trials; ``separating_experiments`` say what to record so that they come apart. ``gain``, ``p_value`` and
    ``likelihood_gain`` (the summed log-likelihood ratio) are of its ``step``; ``survivals`` the same under
    other numerics. ``is_law``: a composed law; ``form_of`` is the effect of the library that has its form, if
    one has. ``together`` names the other effect of a pair; ``gain`` and the trials of the class are then
    beside that one. ``by_held_out`` are its own parameters where the model is fitted to the held-out records
    alone. It is ``shown`` if the records tell its amplitude from zero beside all others in the last model;
    what is not is no name.
    """

    effect: str
    port: str
    title: str
    equation: str
    pattern: str
    source: str
    parameters: Mapping[str, Value]
    known: Mapping[str, Value]
    alike: tuple[str, ...] = field(metadata={"key": "class"})
    class_members: tuple[TriedEffect, ...]
    separating_experiments: tuple[str, ...]
    p_value: float
    gain: float
    at_step: Mapping[str, float]
    likelihood_gain: float
    step: int
    survivals: tuple[Survival, ...]
    is_law: bool = False
    form_of: str = ""
    together: str = ""
    by_held_out: Mapping[str, Value] = field(default_factory=dict)
    shown: bool = True

    @property
    def name(self) -> str:
        """``carriage.viscous``."""
        return f"{self.port}.{self.effect}"

    @property
    def others(self) -> tuple[str, ...]:
        """The effects that it cannot be told from; its own with the port, where that is another one."""
        members = (one for one in self.class_members if one.name != self.name)
        named = (f"{m.effect} at {m.port}" if m.effect == self.effect else m.effect for m in members)
        return tuple(dict.fromkeys(named))


@dataclass(frozen=True)
class ReplacedEffect:
    """Effects that explain more in the place of a declared one, or as much with fewer free parameters.

    ``effects`` are the names of those accepted without ``left_out``, ``parameters`` all of that model.
    ``gain`` is the relative decrease of the held-out RMSE against the last model. ``kind`` is ``better`` or
    ``as_good``. If it is ``better``, ``p_value`` is that of no decrease, adjusted for all that was tried. If
    it is ``as_good``, ``p_value`` is that of no increase: these records cannot tell the two models apart.
    The model has so many free parameters ``fewer`` than the last one (less than zero: more).
    ``held_out_rmse`` is by output.
    """

    left_out: str
    effects: tuple[str, ...]
    kind: Literal["better", "as_good"]
    gain: float
    p_value: float
    fewer: int
    held_out_rmse: Mapping[str, float]
    parameters: Mapping[str, Value]

    @property
    def names(self) -> tuple[str, ...]:
        """The effects with their ports, as ``effects=[...]`` of a config takes them."""
        return tuple(map(as_entry, self.effects))


@dataclass(frozen=True)
class DifferingParameter:
    """A parameter of the last model that was tried with a value for each record.

    ``values`` are those by record, ``gain`` the relative decrease of the held-out RMSE (-1: it could not be
    fitted) to ``held_out_rmse`` by output, ``p_value`` adjusted for all parameters tried. It differs by
    recording if its ``status`` is ``passed``; ``alike`` names other parameters, by recording, and effects
    that the records cannot tell from it. ``in_place_of``: it explains as much in the place of that effect,
    which was accepted.
    """

    parameter: str
    status: str
    reason: str
    gain: float
    p_value: float
    values: Mapping[str, Value]
    held_out_rmse: Mapping[str, float]
    alike: tuple[str, ...] = ()
    in_place_of: str = ""


@dataclass(frozen=True)
class Level:
    """Where a model stands: RMSE over horizons by output, held out and fitted, and the loss over all outputs.

    ``label`` says what changed.
    """

    label: str
    held_out_rmse: Mapping[str, float]
    fitted_rmse: Mapping[str, float]
    loss: float


@dataclass(frozen=True)
class Width:
    """An epsilon in ``unit``: as it was ``declared``, and as it was ``used`` in the end, made narrower where
    the smoothing of sign(v) left an error of its own."""

    name: str
    unit: str
    declared: float
    used: float


@dataclass(frozen=True)
class TriedPair:
    """Two effects that were tried together where no single one passed, and what was decided.

    ``effects`` name them with their ports. ``promised`` is the share that each at least takes from the
    squared error beside the other one, to first order. ``gain`` is the relative decrease of the held-out
    RMSE by both (-1: they could not be fitted), ``gains`` that of each beside the other (empty where both
    together gain too little). ``p_value`` is adjusted for all pairs that could be formed, ``parameters`` are
    their own.
    """

    effects: tuple[str, str]
    status: str
    reason: str
    promised: float
    gain: float
    gains: tuple[float, ...]
    p_value: float
    parameters: Mapping[str, Value]
    seconds: float

    @property
    def name(self) -> str:
        """``carriage.linear_stiffness + carriage.offset``."""
        return " + ".join(self.effects)


@dataclass(frozen=True)
class StepTaken:
    """One step of the search: where its model stood, all trials, the accepted effect and the dropped ones.

    Where no effect passed, ``pairs`` may have been tried, of ``family`` that could be formed. Of an accepted
    pair, ``accepted`` is the first effect and ``together`` the second. ``left_out`` names the effects that
    the time limit left untried; then none is accepted.
    """

    base: Level
    accepted: str | None
    dropped: tuple[str, ...]
    trials: tuple[TriedEffect, ...]
    pairs: tuple[TriedPair, ...] = ()
    family: int = 0
    together: str | None = None
    left_out: tuple[str, ...] = ()

    @property
    def taken(self) -> tuple[str, ...]:
        """The names of what was accepted: nothing, an effect, or a pair."""
        return tuple(name for name in (self.accepted, self.together) if name is not None)


@dataclass(frozen=True)
class LearnedGain:
    """The held-out gain of a learned effort at ``port``, over a variable in ``over_unit``. Divided by its
    factor, the effort is in ``unit``.

    ``p_value`` is adjusted for all that were fitted beside the same model. At a port of the ``kind`` flow, a
    flow was learned.

    ``failure`` says why it could not be solved; its gain is then no evidence. ``ended_early``: its fit
    promised little and ended early, so that the gain is a little less than it could be. Not ``fitted``: a
    first-order estimate, or the time limit, left it out, and its gain of 0 is no evidence either.
    """

    port: str
    over: str
    gain: float
    p_value: float
    unit: str
    over_unit: str
    failure: str = ""
    ended_early: bool = False
    kind: PortKind = "effort"
    fitted: bool = True


@dataclass(frozen=True)
class Floor:
    """What a complete model would leave of an output: the noise level ``value`` (standard deviation) of its
    sensor, the RMS error of the simulation, and that of the parameters, which the noise has moved."""

    value: float
    unit: str
    simulation: float = 0.0
    parameters: float = 0.0


@dataclass(frozen=True)
class UsedRecord:
    """A record and its ``role``: ``fitted`` or ``held out``."""

    name: str
    role: str
    provenance: str
    source: str
    digest: str
    n: int
    dt: float
