"""Slow machines, simulated at 1 Hz: a tank, two tanks of which one may overflow, and a furnace; and a room,
simulated once a minute."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.strangers.recording import Simulated, clock, noisy, run, table

EDGE, WEIR = 0.35, 2e-3  # m; m^1.5/s: of an upper tank that overflows


def tank(seconds: float = 1000.0) -> Simulated:
    t = clock(seconds, 1.0)
    flow = 2e-4 * (1 + 0.6 * np.sign(np.sin(2 * np.pi * t / 250)))  # held between the samples
    level = np.empty_like(t)
    level[0] = 0.1
    for k, held in enumerate(flow[:-1]):
        fill = lambda s, h, inflow: [(inflow - 4e-4 * np.sqrt(max(h[0], 0))) / 0.02]  # noqa: E731
        level[k + 1] = solve_ivp(fill, (0, 1), [level[k]], args=(held,), rtol=1e-9).y[0, -1]
    text = table("time,pump [L/min],level [cm]", t, flow * 6e4, noisy(level) * 100)
    return Simulated(text, {"A": 0.02, "c": 4e-4})


def two_tanks(seconds: float = 1000.0, edge: float = np.inf) -> Simulated:
    """One tank runs into another. Over its edge at ``edge`` m, the upper one overflows into the drain."""
    t = clock(seconds, 1.0)
    slots = np.random.default_rng(3).uniform(0.8e-4, 3.2e-4, len(t) // 60 + 1)
    inflow = np.repeat(slots, 60)[: len(t)]  # held for a minute
    levels = np.empty((2, len(t)))
    levels[:, 0] = 0.2, 0.15
    for k in range(len(t) - 1):

        def rates(_: float, h: np.ndarray, pumped: float = inflow[k]) -> list[float]:
            between, out = (4e-4 * np.sqrt(max(level, 0.0)) for level in h)
            spilled = WEIR * max(h[0] - edge, 0.0) ** 1.5
            return [(pumped - between - spilled) / 0.02, (between - 1.1 * out) / 0.03]

        levels[:, k + 1] = run(rates, levels[:, k].tolist(), np.array([0.0, 1.0]))[:, -1]
    upper, lower = (noisy(level, 5e-3) for level in levels)
    text = table("t [s],pump [L/min],upper [cm],lower [cm]", t, inflow * 6e4, upper * 100, lower * 100)
    return Simulated(text, {"A_1": 0.02, "A_2": 0.03, "c_1": 4e-4, "c_2": 4.4e-4})


def overflowing(seconds: float = 3000.0) -> Simulated:
    """The two tanks, the upper one with an edge that it passes now and then."""
    made = two_tanks(seconds, EDGE)
    return Simulated(made.text, {**made.truth, "upper.overflow.limit": EDGE})


def heater(seconds: float = 2000.0) -> Simulated:
    """A furnace, logged at 1 Hz with decimal commas and a row of units. The heater is told in %, of 2 kW."""
    t = clock(seconds, 1.0)
    share = np.repeat(np.random.default_rng(5).uniform(5, 100, len(t) // 200 + 1), 200)[: len(t)]
    warm = np.empty_like(t)
    warm[0] = 20.0
    decay = np.exp(-2.5 / 1500.0)  # over a second, in which the power is held
    for k, held in enumerate(share[:-1]):
        settled = 20.0 + 20.0 * held / 2.5
        warm[k + 1] = settled + (warm[k] - settled) * decay
    text = table("Uhrzeit;Heizung;Temperatur\ns;%;°C", t, share, noisy(warm), separator=";", decimal=",")
    words = ("--signal", "power=Heizung", "--scale", "power=20")
    return Simulated(text, {"C": 1500.0, "h": 2.5}, words)


def room(minutes: float = 2000.0) -> Simulated:
    """A room, logged once a minute. The heater is held for 40 minutes; it is colder outside by night."""
    capacity, loss, step = 1.8e6, 60.0, 60.0  # J/°C, W/°C, s
    t = clock(step * minutes, 1 / step)
    power = np.repeat(np.random.default_rng(6).uniform(0, 2000, len(t) // 40 + 1), 40)[: len(t)]
    outside = 5.0 - 4.0 * np.cos(2 * np.pi * t / 86400) + 1.5 * np.sin(2 * np.pi * t / 11000)
    lag = capacity / loss
    decay = np.exp(-step / lag)
    warm = np.empty_like(t)
    warm[0] = 20.0
    for k in range(len(t) - 1):  # exact: it is linear outside between the samples
        slope = (outside[k + 1] - outside[k]) / step
        follows = outside[k] - slope * lag + power[k] / loss
        warm[k + 1] = follows + slope * step + (warm[k] - follows) * decay
    text = table("time [min],heating [kW],room [°C],outdoor [°C]", t / 60, power / 1000, noisy(warm), outside)
    return Simulated(text, {"C": capacity, "h": loss}, ("--hold", "surroundings=foh"))
