"""Which effects can be tried where, and from which starts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations, product

from hybridid.effects.effect import Effect
from hybridid.model import Model, Term
from hybridid.plants.plant import TOGETHER, Plant


@dataclass(frozen=True)
class Candidate:
    """An effect that a model could lack, at a port, or at several alike (``front+rear``)."""

    effect: Effect
    port: str

    @property
    def name(self) -> str:
        """``port.effect``, as in the qualified names of its parameters."""
        return Term(self.effect, self.port).name

    @property
    def ports(self) -> tuple[str, ...]:
        """The ports where it acts; several for ports alike."""
        return Term(self.effect, self.port).ports

    @property
    def inner_states(self) -> int:
        """States that the effect adds to a model: with them, a refit takes many times as long."""
        return len(self.effect.states)

    @property
    def free_parameters(self) -> int:
        """How many parameters of the effect are estimated."""
        return sum(not p.fixed for p in self.effect.parameters)

    def added_to(self, model: Model) -> Model:
        """``model`` with the effect at its port.

        Raises:
            ValueError: if the model has that term, or its port does not exist or is of another kind.
        """
        return model.plus(self.effect, self.port)

    def starts(self, model: Model, values: Mapping[str, float]) -> list[dict[str, float]]:
        """Values by name to start the augmented ``model`` from.

        First the effect starts at zero, where the fit of the poorer model ended: with its guessed shape, and
        with each declared value of one shape parameter. Then it starts at each declared value of an amplitude
        (an input that is hardly clipped has no gradient at zero), and at its declared guess. Where the user
        gives guesses of its own parameters, it starts at these, too, at zero and present. None twice. What
        the user has fixed stays so in each.
        """
        port = model.plant.port(self.port)
        own = {p: p.at(port) for p in self.effect.parameters}
        nothing = {f"{self.name}.{p.name}": 0.0 for p in own if p.nests}
        guessed = {f"{self.name}.{p.name}": q.guess for p, q in own.items()}
        shape = {f"{self.name}.{p.name}": q.guess for p, q in own.items() if not p.nests}
        others = [
            {**shape, f"{self.name}.{p.name}": value}
            for p in own
            if not p.nests
            for value in p.starts_at(port)
        ]
        present = [
            {**guessed, f"{self.name}.{p.name}": value} for p in own if p.nests for value in p.starts_at(port)
        ]
        absent = [{**values, **nothing, **one} for one in (shape, *others)]
        begun = [*absent, *({**values, **one} for one in (*present, guessed))]
        given = {name: one.get("guess") for name, one in model.adjustments.items() if name in guessed}
        if told := {name: value for name, value in given.items() if value is not None}:
            begun += [{**values, **guessed, **told}, {**values, **guessed, **told, **nothing}]
        asked = {name: one.get("fixed") for name, one in model.adjustments.items()}
        fixed = {name: value for name, value in asked.items() if value is not None}
        return each_once([{**one, **{name: fixed[name] for name in one if name in fixed}} for one in begun])


def each_once(starts: Sequence[dict[str, float]]) -> list[dict[str, float]]:
    """``starts``, values by name, without those that came before."""
    return list({tuple(sorted(start.items())): start for start in starts}.values())


def admissible(
    model: Model, effects: Sequence[Effect], ports: Sequence[str] | None = None
) -> Iterator[Candidate]:
    """Every effect at every port of its kind where the model does not have it yet, and at ports alike.

    An effect that sees a channel which the model lacks is left out, and one that sees the rate of an output
    that depends on an input at once. So is the sum of others of which the model has one, and what is tried
    only beside an effect that the model lacks there.
    At ports alike only effects without states are tried, and only where none of the ports has them.
    """
    present = {(term.effect.id, name) for term in model.terms for name in term.ports}
    seen = {signal.name for signal in model.signals}
    for effect in effects:
        if not seen.issuperset(effect.channels):
            continue
        for together in _places(model.plant, effect):
            wanted = ports is None or set(together) <= set(ports)
            fits = all(effect.admissible_at(model.plant.port(name)) for name in together)
            fits = fits and not ("rate" in effect.needs and model.at_once.intersection(together))
            had = present.intersection(product((effect.id, *effect.sum_of), together))
            lacks = effect.beside and not present.issuperset(product((effect.beside,), together))
            if wanted and fits and not (had or lacks):
                yield Candidate(effect, TOGETHER.join(together))


def _places(plant: Plant, effect: Effect) -> Iterator[tuple[str, ...]]:
    if effect.into:
        yield from permutations([port.name for port in plant.ports], 2)
        return
    yield from ((port.name,) for port in plant.ports)
    if not effect.states:
        yield from plant.alike
