"""Synthetic data as large as a real record, and every figure made of them."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest

from hybridid.declarations import Parameter, Port
from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.plotting.comparison import comparison_plot
from hybridid.plotting.error import error_plot
from hybridid.plotting.friction import FrictionCurve, FrictionData, friction_plot
from hybridid.plotting.heat_map import Cells, heat_map_plot
from hybridid.plotting.looks import DATA, look
from hybridid.plotting.loop import loop_plot
from hybridid.plotting.panels import Kind, Line, Panel, panels_plot
from hybridid.plotting.parameters import parameters_plot
from hybridid.plotting.raincloud import raincloud_plot
from hybridid.plotting.record import record_plot
from hybridid.plotting.residual_correlation import residual_correlation_plot
from hybridid.plotting.series import Response
from hybridid.plotting.spectrum import amplitude_density, spectrum_plot
from hybridid.plotting.style import DOUBLE_COLUMN, Plot
from hybridid.records.record import Channel, Record
from hybridid.settings.fit import FitSettings
from hybridid.validation import Prediction, residual_tests

N, DT, HORIZON = 24841, 1e-3, 1000
FIGURES = (
    "heat_map",
    "record",
    "comparison",
    "error",
    "loop",
    "friction",
    "spectrum",
    "residual_correlation",
    "raincloud",
    "parameters",
    "panels",
    "scatter",
    "spectra",
)
PORT = Port("carriage", "effort", effort_unit="N", effort_scale=30, position_unit="m", velocity_scale=0.1)
NAMES = ("M", "carriage.viscous.f_v", "carriage.coulomb.f_c", "carriage.offset.offset")
UNITS = ("kg", "N·s/m", "N", "N")


@functools.cache
def make_record(simulated: bool = False, n: int = N) -> Record:
    """A carriage that goes to and fro, with a sensor's noise and one spike in the force."""
    rng = np.random.default_rng(1)
    time = np.arange(n) * DT
    position = 0.12 * (1 - np.cos(time)) + 1e-5 * rng.standard_normal(n)
    force = 40 * np.sign(np.sin(time)) + 5 * rng.standard_normal(n)
    force[n // 2] = 150.0
    reference = 0.12 * (1 - np.cos(time))
    return Record(
        "a rig" if simulated else "identification",
        time,
        force[:, None],
        position[:, None],
        (Channel("force", "N"),),
        (Channel("position", "m"),),
        reference[:, None],
        (Channel("reference", "m"),),
        simulated=simulated,
    )


def make_prediction(record: Record, view: str = "free_run", size: float = 2e-3) -> Prediction:
    """The recorded position with a slow error of ``size`` metres, and one sharp one at 10 s."""
    time = record.time
    error = size * np.sin(1.7 * time) + 4 * size * np.exp(-(((time - 10.0) / 0.05) ** 2))
    breaks = (0,)
    if view == "horizon":
        breaks = tuple(range(0, record.n, HORIZON))
        error = size * ((time / (HORIZON * DT)) % 1.0)
    predicted = record.outputs - error[:, None]
    states = np.zeros((record.n, 2))
    return Prediction(
        record.name, view, record.provenance, time, record.outputs, predicted, states,
        ("position",), ("m",), ("q", "v"), breaks, np.zeros((len(breaks), 2)),
    )  # fmt: skip


@functools.cache
def make_responses(record: Record) -> tuple[Response, ...]:
    """Two models in two views."""
    sizes = {"symmetric friction": 2e-3, "asymmetric viscous": 4e-4}
    views = ("free_run", "horizon")
    return tuple(
        Response.of(m, make_prediction(record, view, size)) for view in views for m, size in sizes.items()
    )


def make_curves() -> list[FrictionCurve]:
    v = np.linspace(-0.15, 0.15, 301)
    efforts = {"viscous": 200 * v, "coulomb": 20 * np.tanh(v / 1e-3), "offset": np.full_like(v, -3.0)}
    more = {**efforts, "asymmetric_viscous": -35 * np.abs(v)}
    return [FrictionCurve("symmetric friction", v, efforts), FrictionCurve("asymmetric viscous", v, more)]


def make_friction_data() -> FrictionData:
    rng = np.random.default_rng(2)
    v = rng.uniform(-0.13, 0.13, N)
    return FrictionData(v, 200 * v + 20 * np.sign(v) - 3 + 4 * rng.standard_normal(N))


def make_estimate(values: tuple[float, ...] = (91.16, 190.2, 22.18, -3.36), **of_last: object) -> Estimate:
    """An estimate of EMPS' parameters; ``of_last`` changes the last one, e.g. ``std=9``."""
    rows = [
        {"name": n, "value": v, "std": 1e-3 * abs(v), "unit": u, "lower": -np.inf, "upper": np.inf}
        for n, v, u in zip(NAMES, values, UNITS, strict=True)
    ]
    rows[-1] |= of_last
    defaults = {"at_bound": False, "identifiable": True}
    correlation = np.array(
        [[1, 0.9, -0.4, 0.1], [0.9, 1, -0.6, 0.4], [-0.4, -0.6, 1, -0.7], [0.1, 0.4, -0.7, 1]]
    )
    return Estimate(
        parameters=tuple(EstimatedParameter(**(defaults | row)) for row in rows),
        known={}, correlation=correlation, initial_states=np.zeros((1, 2)), origin=((0, 0, N),),
        cost=1.0, status="converged", converged=True, iterations=5, seconds={"build": 0.1, "solve": 0.2},
        substeps=1, settings=FitSettings(),
    )  # fmt: skip


def make_panels(record: Record, kind: Kind, width: float) -> Plot:
    """Two panels of one kind, on the data of ``make_responses``; those over time with a part enlarged."""
    data, model = make_responses(record)[:2]
    x, y = ("time", "s"), ("position_of_the_carriage", "m")
    lines = [Line(record.provenance, data.time, data.measured, DATA)]
    lines.append(Line("a model", data.time, model.predicted, look(0)))
    if kind == "scatter":
        x, lines = y, [Line("a model", data.measured, model.predicted, look(0))]
    if kind == "spectrum":
        x, y = ("frequency", "Hz"), ("amplitude density", "m/√Hz")
        lines = [Line(n.label, *amplitude_density(n.x, n.y, n.label), n.look) for n in lines]
    focus = (9.0, 11.0) if kind == "series" else None
    panels = [Panel(title, x, y, lines, kind, focus) for title in ("first", "second")]
    name = {"series": "panels", "scatter": "scatter", "spectrum": "spectra"}[kind]
    columns, row = (2, 84.0) if kind == "scatter" else (1, 40.0)
    caption = f"Two panels ({record.provenance})."
    return panels_plot(name, record.name, panels, caption, record.provenance, columns, row, width)


def declared() -> list[Parameter]:
    scales = (80.0, 150.0, 9.0, 30.0)
    guesses = (80.0, 150.0, 9.0, 0.0)
    return [
        Parameter(n, u, guess=g, scale=s) for n, u, g, s in zip(NAMES, UNITS, guesses, scales, strict=True)
    ]


def make_heat_map(provenance: str, width: float) -> Plot:
    """Two panels of 3 x 3 cells."""
    values = 1e-3 * np.arange(1.0, 10.0).reshape(3, 3)
    panels = [Cells(f"orders.error {k}", k * values, 0.1 * values, (0, 0)) for k in (1, 2)]
    rows, columns = ("layers [–]", ["3", "4", "5"]), ("neurons a layer [–]", ["8", "16", "32"])
    return heat_map_plot(panels, rows, columns, ("held-out RMSE", "m"), "position", provenance, width)


def make_plot(name: str, simulated: bool = False, width: float = DOUBLE_COLUMN) -> Plot:
    record = make_record(simulated)
    where = (record.name, record.provenance)
    makers: dict[str, Callable[[], Plot]] = {
        "record": lambda: record_plot(record, width),
        "comparison": lambda: comparison_plot(make_responses(record)[:2], width),
        "error": lambda: error_plot(make_responses(record), width),
        "loop": lambda: loop_plot([make_responses(record)[:2], make_responses(record)[2:]], width),
        "friction": lambda: friction_plot(PORT, make_curves(), *where, make_friction_data(), width),
        "spectrum": lambda: spectrum_plot(make_responses(record)[:2], width),
        "residual_correlation": lambda: residual_correlation_plot(
            "symmetric friction", residual_tests(make_prediction(record), record)[0], width
        ),
        "raincloud": lambda: raincloud_plot(make_responses(record), width),
        "parameters": lambda: parameters_plot(
            {"first": make_estimate(), "second": make_estimate((84.0, 201.0, 20.4, -3.2))},
            declared(),
            *where,
            width,
        ),
        "panels": lambda: make_panels(record, "series", width),
        "scatter": lambda: make_panels(record, "scatter", width),
        "spectra": lambda: make_panels(record, "spectrum", width),
        "heat_map": lambda: make_heat_map(record.provenance, width),
    }
    return makers[name]()


@pytest.fixture(scope="session")
def record() -> Record:
    return make_record()


@pytest.fixture(scope="session")
def responses(record: Record) -> tuple[Response, ...]:
    return make_responses(record)


@pytest.fixture(scope="session")
def draw() -> Callable[..., Plot]:
    """``draw("error", simulated=True, width=88)``: a new figure."""
    return make_plot


@pytest.fixture(scope="session")
def make(draw: Callable[..., Plot]) -> Callable[..., Plot]:
    """``make("error", simulated=True, width=88)``: drawn once, for tests that do not change it."""
    return functools.cache(draw)


@pytest.fixture(params=FIGURES)
def figure_name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="session")
def predict() -> Callable[..., Prediction]:
    """``predict(record, view, size)``: see ``make_prediction``."""
    return make_prediction


@pytest.fixture(scope="session")
def port() -> Port:
    return PORT


@pytest.fixture(scope="session")
def curves() -> list[FrictionCurve]:
    return make_curves()


@pytest.fixture(scope="session")
def friction_data() -> FrictionData:
    return make_friction_data()


@pytest.fixture(scope="session")
def estimate() -> Callable[..., Estimate]:
    """``estimate(values, **changes of the last parameter)``."""
    return make_estimate


@pytest.fixture(scope="session")
def parameters() -> list[Parameter]:
    return declared()
