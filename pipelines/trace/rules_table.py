"""How a trace was decided: its rules with their numbers, as a table."""

from __future__ import annotations

from hybridid.naming import counted, listed
from hybridid.quantities import percent
from hybridid.trace.trials.cross_fitting import FEW
from hybridid.trace.words.remarks import learned
from pipelines.shared.page import Table
from pipelines.shared.traced import TraceFile


def rules_table(traced: TraceFile) -> Table:
    """The rules of a trace with their numbers, its horizons and records, and how its search ended."""
    found = traced.found
    rules, (fitted, held_out) = found.rules, found.horizons
    both = f"; fewer than {FEW} horizons judge: what they leave open, cross-fitting decides"
    rows = (
        ("horizons", f"{found.split}; {found.horizon:g} s each, {fitted} fitted, {held_out} held out"),
        ("records", listed([f"{r.name} ({r.provenance}, {r.source})" for r in found.records])),
        ("significant", f"adjusted p at most {rules.alpha:g} over all effects tried in a step"
                        + (both if held_out < FEW else "")),
        ("worth having", f"held-out RMSE lower by {percent(rules.worth)} or more"),
        ("alike", f"effects whose errors differ by less than {percent(rules.tie)}, or not significantly"),
        ("identifiable", f"standard errors at most {percent(rules.vague)} of the value, correlations at "
                         f"most {rules.collinear:g}"),
        ("form trusted", f"a {learned(found)} added to the effect contributes at most "
                         f"{percent(rules.stands_in)} of the reduction of the squared error by both; "
                         f"{percent(1 - rules.majority)} where the effect is a curve over its variable; "
                         f"else, above {rules.far:g} times the error of noise and simulation alone, at most "
                         f"{percent(rules.majority)} of what is left"),
        ("form tested", "other functions of its variable with no more parameters, in the place of an effect "
                        "that is alone in its class, do not explain more"),
        ("named", f"above {rules.far:g} times the error of noise and simulation alone: only effects that "
                  f"together take {percent(rules.majority)} of the squared error"),
        ("not minor", f"effects take at least {percent(rules.majority)} of what a {learned(found)} takes "
                      "beside the same model, but for one over its own variable"),
        ("constant amplitude", f"it differs by at most {percent(rules.steady)} between fitted and held-out "
                               "records, or not significantly; freed over another variable, it takes less "
                               f"than {percent(rules.majority)} of the squared error that is left"),
        ("nothing missing", f"said only up to {rules.far:g} times the error of noise and simulation alone"),
        ("search ended", found.stopped),
        ("took", f"{found.seconds:.0f} s on {counted(traced.processes, 'process', 'es')}"),
    )  # fmt: skip
    return Table("Rules", ("", ""), rows, words=(0, 1))
