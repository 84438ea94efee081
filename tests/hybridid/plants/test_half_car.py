"""The half-car against its Lagrangian, the thesis' printed equations, its energy and a truth by SciPy."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import odeint

from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.half_car import HalfCar
from hybridid.records.record import Channel, Record
from hybridid.simulation import simulate

NUMBERS = {
    "m_c": 1250.0, "l_f": 1.5, "l_r": 1.6, "m_f": 30.0, "m_r": 31.0,
    "I_yy": 2441.0, "k_f": 22223.0, "k_r": 52916.0, "c_f": 2273.6, "c_r": 1938.6, "k_t": 2.5e5,
}  # fmt: skip
GRAVITY = 9.81
ROAD = (Channel("u_f", "m", "foh"), Channel("u_r", "m", "foh"))
OUTPUTS = (Channel("vertical_velocity", "m/s"), Channel("pitch_rate", "rad/s"))
UNKNOWN = ("I_yy", "k_f", "k_r", "c_f", "c_r", "k_t")
T = sp.Symbol("t")
Q = [sp.Function(name)(T) for name in ("z_c", "theta", "z_f", "z_r")]
V = [sp.diff(x, T) for x in Q]
P = SimpleNamespace(**{name: sp.Symbol(name, positive=True) for name in NUMBERS})
G, U_F, U_R = sp.symbols("g u_f u_r")


@pytest.fixture(scope="module")
def accelerations() -> list[sp.Expr]:
    """From the Lagrangian and Rayleigh's function of thesis Eqs. 4-1 to 4-13, with k_p = k_t."""
    z_c, theta, z_f, z_r = Q
    d_f, d_r = z_f - (z_c - P.l_f * theta), z_r - (z_c + P.l_r * theta)
    kinetic = (P.m_c * V[0] ** 2 + P.I_yy * V[1] ** 2 + P.m_f * V[2] ** 2 + P.m_r * V[3] ** 2) / 2
    weight = G * (P.m_c * z_c + P.m_f * z_f + P.m_r * z_r)
    springs = P.k_f * d_f**2 + P.k_r * d_r**2 + P.k_t * (U_F - z_f) ** 2 + P.k_t * (U_R - z_r) ** 2
    lagrangian = kinetic - weight - springs / 2
    rayleigh = (P.c_f * sp.diff(d_f, T) ** 2 + P.c_r * sp.diff(d_r, T) ** 2) / 2
    equations = [
        sp.diff(sp.diff(lagrangian, v), T) - sp.diff(lagrangian, q) + sp.diff(rayleigh, v)
        for q, v in zip(Q, V, strict=True)
    ]
    unknown = [sp.diff(x, T, 2) for x in Q]
    solved = sp.solve(equations, unknown, dict=True)[0]
    return [solved[a] for a in unknown]


def printed() -> list[sp.Expr]:
    """The accelerations as Eq. 4-14 prints them, term by term."""
    (z_c, th, z_f, z_r), (dz_c, dth, dz_f, dz_r) = Q, V
    heave = (
        G * P.m_c + P.c_f * dz_c - P.c_f * dz_f + P.c_r * dz_c - P.c_r * dz_r + P.k_f * z_c - P.k_f * z_f
        + P.k_r * z_c - P.k_r * z_r - P.c_f * P.l_f * dth + P.c_r * P.l_r * dth - P.k_f * P.l_f * th
        + P.k_r * P.l_r * th
    )  # fmt: skip
    pitch = (
        P.c_f * P.l_f**2 * dth + P.c_r * P.l_r**2 * dth + P.k_f * P.l_f**2 * th + P.k_r * P.l_r**2 * th
        - P.c_f * P.l_f * dz_c + P.c_f * P.l_f * dz_f + P.c_r * P.l_r * dz_c - P.c_r * P.l_r * dz_r
        - P.k_f * P.l_f * z_c + P.k_f * P.l_f * z_f + P.k_r * P.l_r * z_c - P.k_r * P.l_r * z_r
    )  # fmt: skip
    front = (
        G * P.m_f - P.c_f * dz_c + P.c_f * dz_f - P.k_f * z_c + P.k_f * z_f + P.k_t * z_f - P.k_t * U_F
        + P.c_f * P.l_f * dth + P.k_f * P.l_f * th
    )  # fmt: skip
    rear = (
        P.c_r * dz_c - G * P.m_r - P.c_r * dz_r - P.k_t * z_r + P.k_r * z_c - P.k_r * z_r + P.k_t * U_R
        + P.c_r * P.l_r * dth + P.k_r * P.l_r * th
    )  # fmt: skip
    return [-heave / P.m_c, -pitch / P.I_yy, -front / P.m_f, rear / P.m_r]


def test_the_lagrangian_gives_the_printed_equation(accelerations):
    for derived, thesis in zip(accelerations, printed(), strict=True):
        assert sp.simplify(derived - thesis) == 0


def test_the_plant_is_the_lagrangian_about_its_static_equilibrium(accelerations):
    """Heights from where the car stands under its weight: gravity is in the springs already."""
    place = sp.symbols("a b c d")
    standing = {**dict.fromkeys(V, 0), U_F: 0, U_R: 0}
    rest = [a.subs(standing).subs(dict(zip(Q, place, strict=True))) for a in accelerations]
    static = sp.solve(rest, place, dict=True)[0]
    values = {getattr(P, name): value for name, value in NUMBERS.items()} | {G: GRAVITY}
    assert float(static[place[0]].subs(values)) < -0.1, "the springs carry a weight"
    model, random = compose(HalfCar()), np.random.default_rng(4)
    for _ in range(5):
        x, u = random.normal(size=8), random.normal(size=2)
        about = {q: q + static[s].subs(values) for q, s in zip(Q, place, strict=True)}
        state = dict(zip([*V, *Q], x, strict=True))
        expected = [
            float(
                a.subs(values)
                .subs({v: sp.Symbol(f"v{k}") for k, v in enumerate(V)})
                .subs(about)
                .subs({sp.Symbol(f"v{k}"): state[v] for k, v in enumerate(V)})
                .subs({q: state[q] for q in Q})
                .subs({U_F: u[0], U_R: u[1]})
            )
            for a in accelerations
        ]
        rates = np.asarray(model.f(0, x, u, model.values(NUMBERS))).ravel()
        np.testing.assert_allclose(rates[:4], expected, rtol=1e-9)
        np.testing.assert_allclose(rates[4:], x[:4])


def test_on_a_level_road_it_stays_at_rest():
    model = compose(HalfCar())
    still = np.asarray(model.f(0, np.zeros(8), np.zeros(2), model.values(NUMBERS))).ravel()
    np.testing.assert_array_equal(still, np.zeros(8))


def stored(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Kinetic energy and that of springs and tyres about equilibrium, (n,) [J]."""
    n = NUMBERS
    speed, (z_c, th, z_f, z_r) = x[:, :4], x[:, 4:].T
    kinetic = 0.5 * speed**2 @ np.array([n["m_c"], n["I_yy"], n["m_f"], n["m_r"]])
    d_f, d_r = z_f - z_c + n["l_f"] * th, z_r - z_c - n["l_r"] * th
    return kinetic + 0.5 * (
        n["k_f"] * d_f**2 + n["k_r"] * d_r**2 + n["k_t"] * ((u[:, 0] - z_f) ** 2 + (u[:, 1] - z_r) ** 2)
    )


def test_energy_lost_in_a_simulation_went_through_the_dampers():
    n, dt = 4001, 2.5e-4
    level = Record("decay", np.arange(n) * dt, np.zeros((n, 2)), np.zeros((n, 2)), ROAD, OUTPUTS)
    start = np.array([0.5, -0.3, 0.2, 0.0, 0.05, 0.02, 0.0, -0.01])
    x = simulate(compose(HalfCar()), NUMBERS, level, start, substeps=1).states
    rate_f = x[:, 2] - x[:, 0] + NUMBERS["l_f"] * x[:, 1]
    rate_r = x[:, 3] - x[:, 0] - NUMBERS["l_r"] * x[:, 1]
    power = NUMBERS["c_f"] * rate_f**2 + NUMBERS["c_r"] * rate_r**2
    spent = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * dt)])
    energy = stored(x, level.inputs)
    np.testing.assert_allclose(energy[0] - energy, spent, atol=1e-4 * energy[0])
    assert energy[-1] < 0.2 * energy[0]


def bump(s: np.ndarray) -> np.ndarray:
    """A cosine bump of 1.2 m and 0.1 m; ``s`` in m past its beginning."""
    return np.where((s > 0) & (s < 1.2), 0.1 * np.sin(np.pi * np.clip(s / 1.2, 0, 1)) ** 2, 0.0)


def drive(numbers: dict[str, float], noise: float) -> Record:
    """Over the bump at 20 km/h, integrated by SciPy, at 100 Hz; white ``noise`` on both outputs."""
    time, speed = np.arange(351) * 0.01, 20 / 3.6
    wheelbase = numbers["l_f"] + numbers["l_r"]
    road = np.column_stack([bump(speed * (time - 0.3)), bump(speed * (time - 0.3) - wheelbase)])
    n = SimpleNamespace(**numbers)

    def rate(t, q):
        z_c, th, z_f, z_r, dz_c, dth, dz_f, dz_r = q
        u_f, u_r = np.interp(t, time, road[:, 0]), np.interp(t, time, road[:, 1])
        front = n.k_f * (z_f - z_c + n.l_f * th) + n.c_f * (dz_f - dz_c + n.l_f * dth)
        rear = n.k_r * (z_r - z_c - n.l_r * th) + n.c_r * (dz_r - dz_c - n.l_r * dth)
        heave, pitch = (front + rear) / n.m_c, (n.l_r * rear - n.l_f * front) / n.I_yy
        axle_f, axle_r = (n.k_t * (u_f - z_f) - front) / n.m_f, (n.k_t * (u_r - z_r) - rear) / n.m_r
        return [dz_c, dth, dz_f, dz_r, heave, pitch, axle_f, axle_r]

    states = odeint(rate, np.zeros(8), time, tfirst=True, rtol=1e-9, atol=1e-11, hmax=0.01)
    outputs = states[:, 4:6] + noise * np.random.default_rng(0).normal(size=(len(time), 2))
    return Record("bump", time, road, outputs, ROAD, OUTPUTS, simulated=True)


@pytest.mark.parametrize("integrator", ["rk4", "rodas3"])
def test_a_fit_recovers_the_six_unknowns(integrator):
    """From the declared guesses, with four states of eight that no output shows."""
    truth = NUMBERS | {"m_r": 30.0}
    estimate = fit(compose(HalfCar()), [drive(truth, 1e-3)], FitSettings(integrator=integrator))
    assert estimate.converged
    assert not estimate.warnings
    assert [p.name for p in estimate.parameters] == list(UNKNOWN)
    for p in estimate.parameters:
        assert abs(p.value - truth[p.name]) < 4 * p.std
        assert p.value == pytest.approx(truth[p.name], rel=0.02)


def test_a_fit_finds_that_it_needs_shorter_steps():
    """The thesis' tyre swings its axle five times as fast as the guess; the record hardly tells its k_t."""
    truth = NUMBERS | {"m_r": 30.0, "k_t": 5.1148e6}
    estimate = fit(compose(HalfCar()), [drive(truth, 1e-3)])
    assert estimate.substeps > 4
    assert not estimate.warnings
    for name in UNKNOWN:
        assert estimate.values[name] == pytest.approx(truth[name], rel=0.4 if name == "k_t" else 0.01)


def test_horizons_inside_a_record_find_the_states_that_no_output_shows():
    truth = NUMBERS | {"m_r": 30.0}
    estimate = fit(compose(HalfCar()), [drive(truth, 1e-3)], FitSettings(horizon=100))
    for p in estimate.parameters:
        assert abs(p.value - truth[p.name]) < 4 * p.std
        assert p.value == pytest.approx(truth[p.name], rel=0.03)
