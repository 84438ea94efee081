"""The elastomer joint: Eq. 5-4, the sense of its ports, and what a fit recovers of its friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import odeint
from scipy.signal import chirp

from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.esea import ESEA
from hybridid.records.record import Channel, Record

I, J, K_E = 0.0014, 0.0001, 8.459  # noqa: E741  thesis, Table 5.1
DT = 0.002
NOISE = 0.02
"""rad/s, on the link velocity."""


def test_it_is_the_printed_equation():
    model = compose(ESEA(), ["viscous"])
    for x, torque, f_v in zip(
        np.random.default_rng(0).normal(size=(4, 4)), (0.3, -1.0, 0.0, 2.0), (0, 1e-3, 0.1, 2), strict=True
    ):
        delta_dot, theta_dot, delta, theta = x
        expected = [
            (torque + K_E * theta - K_E * delta - f_v * delta_dot) / J,
            (K_E * delta - K_E * theta) / I,
            delta_dot,
            theta_dot,
        ]
        rates = model.f(0, x, torque, model.values({"motor.viscous.f_v": f_v}))
        np.testing.assert_allclose(np.asarray(rates).ravel(), expected, rtol=1e-12)


def test_the_thesis_friction_lands_on_the_motor():
    assert [t.name for t in compose(ESEA(), ["viscous", "lugre"]).terms] == ["motor.viscous", "motor.lugre"]


def test_an_effort_at_the_elastomer_brakes_the_motor_and_drives_the_link():
    model = compose(ESEA(), ["linear_stiffness@elastomer"])
    x = [0.0, 0.0, 0.02, 0.0]
    rates = [
        np.asarray(model.f(0, x, 0.0, model.values({"elastomer.linear_stiffness.k": k}))).ravel()
        for k in (0.0, 2.0)
    ]
    assert rates[1][0] - rates[0][0] == pytest.approx(-2.0 * 0.02 / J)
    assert rates[1][1] - rates[0][1] == pytest.approx(+2.0 * 0.02 / I)


def test_bounds_free_what_the_plant_takes_as_known():
    assert [p.name for p in compose(ESEA(), ["viscous"]).free] == ["motor.viscous.f_v"]
    freed = compose(ESEA(), ["viscous"], {"K_e": {"lower": 4.0, "upper": 16.0}})
    assert [p.name for p in freed.free] == ["K_e", "motor.viscous.f_v"]


@dataclass(frozen=True)
class Friction:
    """``F = f_v v + f_c (z + tau_b z')``, ``s z' = v - |v| z / (1 + r_s exp(-(v/v_s)²))``."""

    f_v: float = 0.002
    f_c: float = 0.0
    s: float = 1.0
    tau_b: float = 0.0
    r_s: float = 0.0
    v_s: float = 1.0

    def __call__(self, v: float, z: float) -> tuple[float, float]:
        if not self.f_c:
            return self.f_v * v, 0.0
        rate = (v - abs(v) * z / (1 + self.r_s * np.exp(-((v / self.v_s) ** 2)))) / self.s
        return self.f_v * v + self.f_c * (z + self.tau_b * rate), rate


def recorded(friction: Friction, duration: float = 4.0) -> Record:
    """A swept sine of torque, held over each sample; SciPy's LSODA between samples; white noise."""
    time = np.arange(round(duration / DT) + 1) * DT
    torque = 0.1 * chirp(time, 0.5, time[-1], 5.0, phi=-90)
    states = np.zeros((len(time), 5))

    def rate(_, x, held):
        effort, bristle = friction(x[0], x[4])
        twist = K_E * (x[2] - x[3])
        return [(held - twist - effort) / J, twist / I, x[0], x[1], bristle]

    for k in range(len(time) - 1):
        held = (torque[k],)
        states[k + 1] = odeint(rate, states[k], (0, DT), held, tfirst=True, rtol=1e-8, atol=1e-10)[-1]
    velocity = states[:, 1] + NOISE * np.random.default_rng(0).normal(size=len(time))
    inputs, outputs = (Channel("torque", "N·m", "zoh"),), (Channel("link_velocity", "rad/s"),)
    return Record("swept sine", time, torque[:, None], velocity[:, None], inputs, outputs, simulated=True)


def noise_floor(record: Record) -> float:
    """What the cost is at the truth: half the sum of squares of the noise, in standard deviations."""
    return 0.5 * record.n * NOISE**2 / record.outputs.var()


@pytest.mark.parametrize("horizon", [None, 250])
def test_linear_friction_is_recovered(horizon):
    record = recorded(Friction(f_v=0.002), 2.0)
    estimate = fit(compose(ESEA(), ["viscous"]), [record], FitSettings(horizon=horizon))
    (f_v,) = estimate.parameters
    assert abs(f_v.value - 0.002) < 4 * f_v.std
    assert f_v.value == pytest.approx(0.002, rel=2e-3)
    assert estimate.cost == pytest.approx(noise_floor(record), rel=0.1)


@pytest.mark.parametrize(
    ("effects", "friction", "rel"),
    [
        (["dahl"], Friction(f_v=0.0, f_c=0.03, s=0.02), 0.02),
        (["viscous", "lugre"], Friction(f_c=0.03, s=0.02, tau_b=0.004, r_s=0.5, v_s=1.0), 0.02),
    ],
    ids=["dahl", "lugre"],
)
def test_bristle_friction_is_recovered_by_the_implicit_method(effects, friction, rel):
    """From the declared guesses, free-running over the whole record; what it cannot tell, it says."""
    record = recorded(friction)
    estimate = fit(compose(ESEA(), effects), [record], FitSettings(integrator="rodas3"))
    assert estimate.converged
    for p in estimate.parameters:
        assert abs(p.value - getattr(friction, p.name.rpartition(".")[2])) < 5 * p.std
    assert estimate.values[f"motor.{effects[-1]}.f_c"] == pytest.approx(friction.f_c, rel=rel)
    assert estimate.cost == pytest.approx(noise_floor(record), rel=0.1)
