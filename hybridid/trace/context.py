"""``Context``: what every part of a trace works with."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from hybridid.declarations import Port
from hybridid.effects.effect import Effect
from hybridid.effects.library import EFFECTS
from hybridid.effects.over import Over, overs_for
from hybridid.effects.variable import Variable
from hybridid.model import Model
from hybridid.trace.candidates import Candidate, admissible
from hybridid.trace.horizons.noise import Noise
from hybridid.trace.horizons.score import Score
from hybridid.trace.horizons.split import Split
from hybridid.trace.mapper import Mapper, Report, serial, silent, unheard
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import PAIRS, Rules

T = TypeVar("T")


def nothing_known(*given: Any) -> int:
    """All may take equally long."""
    return 0


def unlabelled(result: Any) -> str:
    """A result is counted, not named."""
    return ""


@dataclass(frozen=True, eq=False)
class Context:
    """The horizons of a trace, what is tried where, by which rules, and how the refits run.

    ``effects`` are tried at every port of their kind, or only at ``ports``. ``mapper`` runs refits one after
    another or side by side; ``report`` follows them, and ``say`` is told what each step decides. ``laws``:
    where no effect explains what a learned effort finds, laws are composed. ``pairs``: so many pairs of
    effects are refitted where no single effect explains it. ``revise``: each declared effect is left out in
    turn, and others are sought in its place. Learned efforts, and the laws that follow them, depend on
    ``variables`` (None: all that a port has). From ``until`` on (s, as ``time.monotonic``) nothing further
    begins. No model of more than ``most_free`` free parameters is tried. Where parameters with values of
    their own for each recording leave no more than noise (``own_values``), only one effect may do as well.
    """

    split: Split
    effects: tuple[Effect, ...] = EFFECTS
    rules: Rules = field(default_factory=Rules)
    ports: tuple[str, ...] | None = None
    mapper: Mapper = serial
    report: Report = silent
    say: Callable[[str], None] = unheard
    laws: bool = True
    pairs: int = PAIRS
    revise: bool = False
    variables: tuple[Variable, ...] | None = None
    until: float = math.inf
    most_free: float = math.inf
    own_values: bool = False

    @property
    def out_of_time(self) -> bool:
        """Whether nothing further is to be begun."""
        return not self.has_time_for(0.0)

    def has_time_for(self, seconds: float) -> bool:
        """Whether what takes so long would end before nothing further is to be begun."""
        return time.monotonic() + seconds < self.until

    @cached_property
    def noise(self) -> Noise:
        """The noise of the sensors."""
        return Noise.of(self.split.records)

    @cached_property
    def declared(self) -> dict[Hashable, Refit]:
        """The refits of the declared model over these horizons, each by what it was made from."""
        return {}

    def meets_noise(self, score: Score) -> bool:
        """Whether the held-out error of a model is that of the sensors' noise, in each output: the noise of a
        poor sensor hides in the loss what a good one shows."""
        return bool(np.all(score.rmse <= self.rules.near_floor * self.noise.beside(score)))

    def noise_leaves_no_room(self, score: Score) -> bool:
        """Whether the sensors' noise, of all outputs together, makes so much of the held-out loss that no
        effect can take ``Rules.worth`` from it, whatever is missing."""
        noise = np.minimum(self.noise.beside(score), score.rmse)
        of_noise = float(np.sqrt(np.mean((noise / score.scale) ** 2)))
        most = min(self.rules.near_floor, 1.0 / (1.0 - self.rules.worth))
        return score.loss <= most * of_noise

    def candidates(self, model: Model) -> list[Candidate]:
        """The effects that this trace tries beside those of ``model``."""
        possible, room = admissible(model, self.effects, self.ports), self.most_free - len(model.free)
        return [one for one in possible if one.free_parameters <= room]

    def equation_ports(self, model: Model) -> list[Port]:
        """The effort and flow ports of ``model`` where this trace tries something."""
        return [port for port in model.equation_ports if self.ports is None or port.name in self.ports]

    def overs(self, port: Port, model: Model) -> list[Over]:
        """What learned efforts or flows at ``port`` of ``model`` depend on in this trace."""
        every = overs_for(port, model.plant.inputs, model.channels)
        return [over for over in every if self.variables is None or over.variable in self.variables]

    def one(self, function: Callable[..., T], *given: Any) -> T:
        """``function(*given)`` by the mapper, which may keep its results."""
        (result,) = self.mapper(function, [given])
        return result

    def each(
        self,
        stage: str,
        function: Callable[..., T],
        arguments: Sequence[tuple[Any, ...]],
        label: Callable[[T], str] = unlabelled,
        slow: Callable[..., int] = nothing_known,
        always: int | None = None,
    ) -> list[T]:
        """``function`` of each of ``arguments``, in their order; the beginning is reported, and then every
        result by its ``label``.

        Those for which ``slow`` is larger begin first, so that at the end no process waits long for another
        (longest processing time first: Graham 1969, SIAM J. Appl. Math. 17(2), 416-429).

        Where ``always`` is given, a time limit may leave out the last ones: they begin in the order given, so
        many of them in any time, the others while there is time.
        """
        limited = always is not None and math.isfinite(self.until)
        every = range(len(arguments))
        order = every if limited else sorted(every, key=lambda k: -slow(*arguments[k]))
        begun = (arguments[k] for k in order if not limited or k < (always or 0) or not self.out_of_time)
        results: dict[int, T] = {}
        if arguments:
            self.report(stage, 0, len(arguments), "")
        for k, result in zip(order, self.mapper(function, begun), strict=not limited):
            results[k] = result
            self.report(stage, len(results), len(arguments), label(result))
        return [results[k] for k in every if k in results]
