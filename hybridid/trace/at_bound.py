"""Parameters of accepted effects that end at a bound in the last model.

The bound of a shape parameter (a length, a time) comes from the scale of its port: it is a guess of what is
reasonable. A trial that ends there is refused. But a parameter may also run to its bound later, as other
effects join the model. Then the machine's own value may lie beyond, and all others make up for it.
"""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.quantities import quantity
from hybridid.trace.entries import AcceptedEffect

WIDER = 10.0
"""Times the bound that is proposed in its place."""


def ends_at_bound(accepted: Sequence[AcceptedEffect], estimate: Estimate) -> str:
    """Which parameters of ``accepted`` effects the ``estimate`` of the last model leaves at a bound, and how
    to go on with a wider one, in words; empty if none. A bound of zero is physics, and not told."""
    by_name = {one.name: one for one in estimate.parameters}
    own = [(entry, by_name.get(f"{entry.name}.{name}")) for entry in accepted for name in entry.parameters]
    return "".join(_told(entry, one) for entry, one in own if one and one.at_bound and one.value)


def _told(entry: AcceptedEffect, one: EstimatedParameter) -> str:
    below = abs(one.value - one.lower) < abs(one.value - one.upper)
    side, bound = ("lower", one.lower) if below else ("upper", one.upper)
    inward = below == (bound > 0)  # whether the bound moves towards zero
    wider = bound / WIDER if inward else bound * WIDER
    return (
        f" Beware: {one.name.removeprefix(entry.name + '.')} of {entry.name} ends at its {side} bound, "
        f"{quantity(bound, one.unit, 3)}. The machine's own may lie beyond, and the others make up for it: "
        f"go on with a wider one, as parameters.{one.name}.{side}={wider:.3g}."
    )
