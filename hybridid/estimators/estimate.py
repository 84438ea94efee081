"""``Estimate``: what a fit found, and how far it can be trusted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.settings.fit import FitSettings

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Progress:
    """One report from a running fit; ``fraction`` of the work done where it is known."""

    stage: str
    iteration: int
    cost: float
    fraction: float | None = None


@dataclass(frozen=True)
class EstimatedParameter:
    """One estimate.

    ``std`` is its standard error: noise, autocorrelated as it is, and ``smoothing``, the part
    that the smoothing of sign(v) may have moved it by (signed: estimate less unsmoothed). A fit that has not
    converged has none: ``std`` is nan, and ``identifiable`` says nothing.
    """

    name: str
    value: float
    std: float
    unit: str
    lower: float = field(metadata={"null": -math.inf})
    upper: float = field(metadata={"null": math.inf})
    at_bound: bool
    identifiable: bool
    meaning: str = ""
    smoothing: float = 0.0


@dataclass(frozen=True)
class Left:
    """What a fit leaves of one output over its horizons, beside what a complete model would leave; in
    ``unit``.

    ``rmse`` is the RMS error, without what better initial states would take if they are not estimated.
    ``noise`` is the sensor's standard deviation, nan where the records do not tell it. ``simulation`` is the
    RMS error of the smoothing of sign(v) and of the step's length together, ``step`` that of the step's
    length alone. ``louder`` is the p-value of a residual that is no louder in motion than at rest; nan where
    the noise is told, and nobody asks. ``exceeded``: it is more than noise and simulation leave.
    """

    output: str
    unit: str
    rmse: float
    noise: float
    simulation: float
    step: float
    louder: float
    exceeded: bool

    @property
    def smeared(self) -> float:
        """The RMS error of the smoothing of sign(v) alone."""
        return math.sqrt(max(self.simulation**2 - self.step**2, 0.0))

    @property
    def times(self) -> float:
        """The error over what noise and simulation leave together; nan where the noise is not told."""
        limit = math.hypot(self.noise, self.simulation)
        return self.rmse / limit if limit > 0 else math.nan


@dataclass(frozen=True)
class AllOne:
    """A test that all groups of records have one value: ``chi_square`` then has ``degrees`` of freedom.

    ``p_value`` is the probability of as much or more then. Both are nan where the fit states no standard
    errors.
    """

    chi_square: float
    degrees: int
    p_value: float

    def withheld(self) -> AllOne:
        """Nothing but its degrees of freedom."""
        return AllOne(math.nan, self.degrees, math.nan)


@dataclass(frozen=True)
class Difference:
    """How the values of one ``parameter`` differ between ``groups`` of records, in ``unit``.

    ``spread`` is their standard deviation, that of a sample.
    """

    parameter: str
    unit: str
    groups: tuple[str, ...]
    mean: float
    lowest: float
    highest: float
    spread: float
    test: AllOne = field(metadata={"inline": True})


@dataclass(frozen=True)
class Solution:
    """Where an optimiser stopped: parameters (n_p,), initial states (w, n_x), half sum of squares."""

    p: Array
    x0: Array
    cost: float
    status: str
    converged: bool
    iterations: int
    history: tuple[float, ...] = ()


@dataclass(frozen=True)
class Estimate:
    """A fitted model's numbers.

    ``cost`` is half the sum of squared output errors, each over its output's standard
    deviation. ``correlation`` (n, n) is of the estimated ``parameters`` in their order;
    ``known`` holds the values that were not estimated. ``initial_states`` (w, n_x) belong
    to the horizons in ``origin``, rows of (record index, first sample, end sample). ``left`` is what it
    leaves of each output, ``starts`` the costs at which the descents from several starts ended,
    ``differences`` how parameters with a value for each group of records differ, and ``together`` the test of
    several such parameters at once.
    """

    parameters: tuple[EstimatedParameter, ...] = field(metadata={"by": "name"})
    known: Mapping[str, float]
    correlation: Array
    initial_states: Array
    origin: tuple[tuple[int, int, int], ...]
    cost: float
    status: str
    converged: bool
    iterations: int
    seconds: Mapping[str, float]
    substeps: int
    settings: FitSettings
    history: tuple[float, ...] = ()
    starts: tuple[float, ...] = ()
    warnings: tuple[str, ...] = ()
    left: tuple[Left, ...] = field(default=(), metadata={"by": "output"})
    differences: tuple[Difference, ...] = field(default=(), metadata={"by": "parameter"})
    together: AllOne | None = None

    @property
    def values(self) -> dict[str, float]:
        """Every parameter of the model by name, estimated or known."""
        return {**self.known, **{p.name: p.value for p in self.parameters}}

    def withheld(self) -> Estimate:
        """The same without its standard errors and tests."""
        return replace(
            self,
            parameters=tuple(replace(p, std=math.nan) for p in self.parameters),
            differences=tuple(replace(one, test=one.test.withheld()) for one in self.differences),
            together=self.together and self.together.withheld(),
        )
