"""The members of a class with the standard errors that are told.

A trial is judged by the standard errors of the noise alone. The last fit, by which an accepted effect is
told, has the share of the smoothing of sign(v) as well. A member of its class that is told beside it must not
seem better known, so its standard errors get that share, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybridid.trace.constancy import with_smoothing
from hybridid.trace.context import Context
from hybridid.trace.steps import Accepted
from hybridid.trace.trial import Trial


def with_told_errors(accepted: Sequence[Accepted], context: Context) -> tuple[Accepted, ...]:
    """``accepted``, the members of whose classes have standard errors with the share of the smoothing."""
    members = [(one.name, t) for one in accepted if len(one.alike) > 1 for t in one.alike]
    known = {(name, t.candidate.name): t.refit for name, t in members if t.refit and t.refit.std}
    given = [(one, context.split) for one in known.values()]
    told = dict(zip(known, context.each("standard errors of a class", with_smoothing, given), strict=True))

    def as_told(one: Accepted, member: Trial) -> Trial:
        return replace(member, refit=told.get((one.name, member.candidate.name), member.refit))

    return tuple(replace(one, alike=tuple(as_told(one, t) for t in one.alike)) for one in accepted)
