"""Flows that leave a tank: Francis' and Torricelli's laws, and found again on a level that overflows."""

from __future__ import annotations

from typing import final

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.plant import Motion, Plant
from hybridid.records.record import Channel, Record

AREA, DT, N = 0.02, 1.0, 600  # m², s


def test_an_overflow_is_a_weirs(bench):
    """Nothing below the edge, 1.84 b H^1.5 above it, for a weir of b = 0.2 m."""
    h = 0.1
    weir = bench("overflow", k=1.84 * 0.2 * h**0.5, limit=0.3, h=h, width=1e-6)
    for level in (0.31, 0.35, 0.6):
        assert weir.law(position=level) == pytest.approx(1.84 * 0.2 * (level - 0.3) ** 1.5, rel=1e-3)
    assert weir.law(position=0.29) == pytest.approx(0.0, abs=1e-12)


def test_an_orifice_is_torricellis_both_ways(bench):
    hole = bench("orifice_leak", c=3.0, h=0.25, width=1e-6)
    for level in (0.01, 0.25, 1.0):
        assert hole.law(position=level) == pytest.approx(3.0 * np.sqrt(level / 0.25), rel=1e-6)
        assert hole.law(position=-level) == -hole.law(position=level)


@final
class Tank(Plant):
    """``A h' = inflow - F``: a tank with no outlet of its own."""

    name, meaning, source = "tank", "a tank", "this test"
    states = (State("level", "m", scale=0.3, observed_by="level", derivative=0),)
    inputs = (Signal("inflow", "m³/s"),)
    outputs = (Signal("level", "m"),)
    parameters = (Parameter("A", "m²", guess=AREA, fixed=True),)
    ports = (
        Port("tank", "effort", "m³/s", 1e-3, "m", 0.3, velocity_scale=0.05, no_load="water"),
        Port("inflow", "input", "m³/s", 1e-3),
        Port("level", "output", "m", 0.3),
    )

    def motion(self, x, u, p):
        return {"tank": Motion(position=x.level, velocity=u.inflow / p.A)}

    def derivative(self, x, u, p, effort):
        return {"level": (u.inflow - effort["tank"]) / p.A}

    def output(self, x, u, p):
        return {"level": x.level}


def test_a_weir_and_a_hole_are_found_again():
    """The truth is integrated by SciPy, with a sharp edge."""
    inflow = 4e-4 * (1 + np.sin(2 * np.pi * np.arange(N) * DT / 150))

    def rate(_: float, x: np.ndarray, u: float) -> list[float]:
        flows = 6e-4 * np.sqrt(max(x[0], 0.0)) + 0.04 * max(x[0] - 0.4, 0.0) ** 1.5
        return [(u - flows) / AREA]

    level = np.full((N, 1), 0.35)
    for k, u in enumerate(inflow[:-1]):
        level[k + 1] = solve_ivp(rate, (0, DT), level[k], args=(u,), rtol=1e-9, atol=1e-11).y[:, -1]
    assert level.max() > 0.44
    assert level.min() < 0.35
    channels = (Channel("inflow", "m³/s", "zoh"),), (Channel("level", "m"),)
    record = Record("weir", DT * np.arange(N), inflow[:, None], level, *channels, simulated=True)
    known = {"tank.overflow.h": {"fixed": 1.0}, "tank.orifice_leak.h": {"fixed": 1.0}}
    model = compose(Tank(), ["overflow", "orifice_leak"], known)
    settings = FitSettings(start="guess", continuation=(1.0,), initial_state="measured", substeps=4)
    start = {"tank.overflow.k": 0.0, "tank.overflow.limit": 0.3, "tank.orifice_leak.c": 0.0}
    found = fit(model, [record], settings, start_values=start).values
    assert found["tank.overflow.k"] == pytest.approx(0.04, rel=0.02)
    assert found["tank.overflow.limit"] == pytest.approx(0.4, abs=2e-3)
    assert found["tank.orifice_leak.c"] == pytest.approx(6e-4, rel=0.01)
