"""Whether the narrow smoothing of sign(v) is what makes a trace slow.

Near rest the slope of a smoothed dry friction is f_c / (m epsilon), and an integrator's step is about the
inverse of that. An epsilon far below the speeds that count makes every trial slower, and shows no more.
"""

from __future__ import annotations

from hybridid.naming import listed
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refitted import Refit

MANY = 16
"""Steps a sample from which on they are told: smooth motion takes one to eight."""
WIDER = 4.0
"""Times each epsilon for which the steps are counted as well."""


def many_steps(base: Refit, split: Split) -> str:
    """That the model of ``base`` takes many steps a sample, and half of them at most with a wider smoothing
    of sign(v), in words; empty where either is not so."""
    taken = base.steps
    problem = base.problem(split)
    if taken < MANY or not problem.widths:
        return ""
    wider = problem.smoothed(base.model.values(base.values), WIDER * base.numerics.smoothing)
    needed = base.numerics.steps(base.model, wider, split)
    if 2 * needed > taken:
        return ""
    own = {problem.model.parameters[k].name: wider[k] for k in problem.widths}
    settings = listed([f"+parameters.{name}.guess={value:.2g}" for name, value in own.items()])
    return (
        f"a sample takes {taken} steps, as sign(v) is smoothed so narrowly: with {settings} it "
        f"takes {needed}, and each trial is quicker. Where that leaves more error, a trace narrows it again"
    )
