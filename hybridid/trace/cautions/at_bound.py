"""Parameters that end at a bound in the last model.

The bound of a shape parameter (a length, a time) comes from the scale of its port: it is a guess of what is
reasonable. A trial that ends there is refused. But a parameter may also run to its bound later, as other
effects join the model, and one of the plant may do so from the first fit on. Then the machine's own value may
lie beyond, and all others make up for it.
"""

from __future__ import annotations

from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.quantities import quantity

WIDER = 10.0
"""Times the bound that is proposed in its place."""


def ends_at_bound(estimate: Estimate) -> str:
    """Which parameters the ``estimate`` of the last model leaves at a bound, and how to go on with a wider
    one, in words; empty if none. A bound of zero is physics, and not told."""
    return "".join(_told(one) for one in estimate.parameters if one.at_bound and one.value)


def _told(one: EstimatedParameter) -> str:
    below = abs(one.value - one.lower) < abs(one.value - one.upper)
    side, bound = ("lower", one.lower) if below else ("upper", one.upper)
    inward = below == (bound > 0)  # whether the bound moves towards zero
    wider = bound / WIDER if inward else bound * WIDER
    told, setting = f"{quantity(bound, one.unit, 3)}", f"parameters.{one.name}.{side}"
    *effect, own = one.name.rsplit(".", 1)
    if not effect:
        return (
            f" Beware: {own} ends at its {side} bound, {told}. Unless physics sets that bound, the machine's "
            f"own may lie beyond, and the others make up for it: {setting} sets another one."
        )
    return (
        f" Beware: {own} of {effect[0]} ends at its {side} bound, {told}. The machine's own may lie beyond, "
        f"and the others make up for it: go on with a wider one, as {setting}={wider:.3g}."
    )
