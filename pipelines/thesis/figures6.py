"""Figures of Chapter 6: the EMPS with an RBF network inside its equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hybridid.plotting.comparison import comparison_plot
from hybridid.plotting.looks import look
from hybridid.plotting.panels import Line, Panel
from hybridid.plotting.raincloud import raincloud_plot
from hybridid.plotting.record import record_plot
from hybridid.plotting.style import Plot
from hybridid.validation.port_efforts import port_efforts
from pipelines.plot.laws import friction_plots, laws_of
from pipelines.thesis.chapter6 import DIRECTION, FREE, HORIZON, NODES, OUTPUT, PORT
from pipelines.thesis.figure import Draw, Figure, plot_of
from pipelines.thesis.look_up import Missing
from pipelines.thesis.views import Run, Runs

SHOWN = 4
"""Nodes of the network that the thesis' figures show."""
ROLE = "validation"


def _run(runs: Runs) -> Run:
    return runs[NODES[SHOWN]]


def _record(role: str) -> Draw:
    return lambda runs: record_plot(runs.first((NODES[SHOWN], FREE, HORIZON, DIRECTION)).record(role))


def _comparison(runs: Runs) -> Plot:
    return comparison_plot(list(_run(runs).both(ROLE, OUTPUT).values()))


def _absolute(runs: Runs) -> Plot:
    run = _run(runs)
    shown = run.both(ROLE, OUTPUT)
    lines = [
        Line(f"{name}, |error|", r.time, np.abs(r.error), look(k))
        for k, (name, r) in enumerate(shown.items())
    ]
    unit = shown["gray box"].unit
    panel = Panel("free run", ("time", "s"), (f"|error| of {OUTPUT}", unit), lines)
    return plot_of(run.record(ROLE), "absolute errors of gray box and hybrid", [panel], row=60.0)


def _raincloud(runs: Runs) -> Plot:
    run = _run(runs)
    views = ("free_run", "horizon")
    return raincloud_plot([r for view in views for r in run.both(ROLE, OUTPUT, view).values()])


def _over_time(runs: Runs) -> Plot:
    """Viscous and Coulomb friction of the hybrid's physics, and the network's, over time."""
    run = _run(runs)
    record = run.record(ROLE)
    law = laws_of(run.settings, run.tree)[-1]
    prediction = next(
        s.prediction for s in run.stored
        if (s.model, s.prediction.record, s.horizon) == (law.name, record.name, None)
    )  # fmt: skip
    at = next(p for p in port_efforts(law.model, law.values, record, prediction) if p.port.name == PORT)
    network = f"{PORT}.rbf"
    if network not in at.efforts:
        raise Missing("no network at the carriage")
    physics = [effort for name, effort in at.efforts.items() if name not in (network, f"{PORT}.offset")]
    lines = [
        Line("physics, F_f", prediction.time, np.sum(physics, axis=0), look(0)),
        Line("network, F_rbf", prediction.time, at.efforts[network], look(1)),
    ]
    half = (float(prediction.time[0]), float(prediction.time[-1]) / 6)
    panel = Panel("efforts that resist", ("time", "s"), ("friction", at.port.effort_unit), lines, focus=half)
    return plot_of(record, "friction of the hybrid's physics and of its network", [panel], row=60.0)


def _over_velocity(runs: Runs) -> Plot:
    run = _run(runs)
    record = run.record(ROLE)
    own = [s for s in run.stored if s.prediction.record == record.name and s.horizon is None]
    for port, draw in friction_plots(laws_of(run.settings, run.tree), record, own):
        if port.name == PORT:
            return replace(draw(), name="friction")
    raise Missing("no friction at the carriage")


FIGURES = (
    Figure("6.1", "identification record", _record("identification")),
    Figure("6.2", "validation record", _record("validation")),
    Figure("6.4", f"data, gray box and hybrid with {SHOWN} nodes, validation record", _comparison),
    Figure("6.5", f"absolute errors of gray box and hybrid with {SHOWN} nodes, validation record", _absolute),
    Figure("6.6", f"distributions of the errors of gray box and hybrid with {SHOWN} nodes", _raincloud),
    Figure("6.7", "friction of gray box and network over time", _over_time),
    Figure("6.8", "friction over velocity, gray box and hybrid", _over_velocity),
)
NOT_DRAWN = "Figure 6.3 is a diagram of the network."
