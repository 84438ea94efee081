"""Whether a gain survives another way to solve the equations.

Half a sample of delay, a coarse step or a wide smoothing of sign(v) can look like an
effect. A gain that vanishes when they change was made by them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybridid.records.record import Hold, Record
from hybridid.trace.evidence import Rules, compare
from hybridid.trace.refit import Numerics, Refit, refit
from hybridid.trace.split import Split

OTHER_HOLD: Mapping[Hold, Hold] = {"zoh": "foh", "foh": "bandlimited", "bandlimited": "foh"}


@dataclass(frozen=True)
class Survival:
    """The gain of an effect under one variation, its parameters there, and whether it still passes."""

    variation: str
    gain: float
    p_value: float
    parameters: Mapping[str, float]
    survives: bool


def variations(records: Sequence[Record]) -> tuple[Numerics, ...]:
    """Changes of smoothing, step, integrator and input hold that no effect should feel."""
    hold = OTHER_HOLD[records[0].input_channels[0].hold]
    return (
        Numerics("epsilon x 3", smoothing=3.0),
        Numerics("epsilon / 2", smoothing=0.5),
        Numerics("half the step", finer=2),
        Numerics("another integrator", integrator="rodas3"),
        Numerics(f"inputs {hold}", hold=hold),
    )


def survival(
    base: Refit, augmented: Refit, term: str, split: Split, numerics: Numerics, rules: Rules
) -> Survival:
    """Refit both models under ``numerics`` and compare them again.

    The effect's own parameters must stay what they were: an amplitude that follows the
    smoothing or the step belongs to them, not to the machine.
    """
    poorer = refit(base.model, split, [base.values], base, numerics)
    richer = refit(augmented.model, split, [augmented.values], augmented, numerics)
    again = compare(poorer.score, richer.score)
    own = {name: value for name, value in richer.values.items() if name.startswith(f"{term}.")}
    steady = all(
        abs(v - augmented.values[k]) <= rules.steady * abs(augmented.values[k]) for k, v in own.items()
    )
    passes = again.gain >= rules.worth and again.p_value <= rules.alpha and steady
    return Survival(numerics.name, again.gain, again.p_value, own, passes)
