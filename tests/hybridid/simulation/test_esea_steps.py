"""The integrator and steps of conf/friction against SciPy's LSODA, at parameters that fits end at."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.integrate import odeint
from scipy.signal import chirp

from hybridid.model import compose
from hybridid.plants.esea import ESEA
from hybridid.records.record import Channel, Record
from hybridid.simulation import simulate

FRICTIONS = Path(__file__).parents[3] / "conf" / "friction"
DT, I, J, K_E = 0.002, 0.0014, 0.0001, 8.459  # noqa: E741
EPSILON = 0.07
ALLOWED = 1e-4
"""RMS error over the RMS of the link velocity; the encoder's counts and noise are a hundred times that."""
LUGRE = ("viscous.f_v", "lugre.f_c", "lugre.s", "lugre.tau_b", "lugre.r_s", "lugre.v_s")
AT = {
    "linear": [{"viscous.f_v": 0.01}, {"viscous.f_v": 0.0202}],
    "coulomb_stribeck": [
        {"viscous.f_v": 0.004, "coulomb.f_c": 0.045, "stribeck.df_s": 0.015, "stribeck.v_s": 1.0},
        {"viscous.f_v": 0.0065, "coulomb.f_c": 0.0414, "stribeck.df_s": 0.0445, "stribeck.v_s": 1.28},
    ],
    "dahl": [{"dahl.f_c": 0.045, "dahl.s": 0.005}, {"dahl.f_c": 0.0986, "dahl.s": 0.031}],
    "lugre": [
        dict(zip(LUGRE, (0.004, 0.045, 0.005, 0.00111, 1 / 3, 1.0), strict=True)),
        dict(zip(LUGRE, (0.012, 0.0259, 0.0208, 0.0, 2.52, 2.47), strict=True)),
    ],
}
"""By friction: as the rig is declared, and as fitted to the default rig."""


def resisting(p: dict[str, float], v: float, z: float) -> tuple[float, float]:
    """Friction and the bristles' rate (thesis Eqs. 5-5 to 5-10, the exponent decaying)."""
    effort = p.get("viscous.f_v", 0.0) * v
    sign = np.tanh(v / EPSILON)
    if "coulomb.f_c" in p:
        peak = p["stribeck.df_s"] * np.exp(-((v / p["stribeck.v_s"]) ** 2))
        return effort + (p["coulomb.f_c"] + peak) * sign, 0.0
    if "dahl.f_c" in p:
        return effort + p["dahl.f_c"] * z, (v - abs(v) * z) / p["dahl.s"]
    if "lugre.f_c" in p:
        level = 1 + p["lugre.r_s"] * np.exp(-((v / p["lugre.v_s"]) ** 2))
        rate = (v - abs(v) * z / level) / p["lugre.s"]
        return effort + p["lugre.f_c"] * (z + p["lugre.tau_b"] * rate), rate
    return effort, 0.0


def reference(p: dict[str, float], duration: float = 0.6) -> Record:
    """A swept sine of torque, held over each sample; LSODA in between, tolerance 1e-7."""
    time = np.arange(round(duration / DT) + 1) * DT
    torque = 0.25 * chirp(time, 1.0, time[-1], 5.0, phi=-90)
    states = np.zeros((len(time), 5))

    def rate(_, x, held):
        effort, bristles = resisting(p, x[0], x[4])
        twist = K_E * (x[2] - x[3])
        return [(held - twist - effort) / J, twist / I, x[0], x[1], bristles]

    for k in range(len(time) - 1):
        held = (torque[k],)
        states[k + 1] = odeint(rate, states[k], (0, DT), held, tfirst=True, rtol=1e-7, atol=1e-9)[-1]
    inputs, outputs = (Channel("torque", "N·m", "zoh"),), (Channel("link_velocity", "rad/s"),)
    return Record("LSODA", time, torque[:, None], states[:, 1:2], inputs, outputs, simulated=True)


@pytest.mark.parametrize("which", [0, 1], ids=["declared", "fitted"])
@pytest.mark.parametrize("friction", AT)
def test_the_steps_of_the_case_are_fine_enough(friction, which):
    config = yaml.safe_load((FRICTIONS / f"{friction}.yaml").read_text(encoding="utf-8"))
    estimator, p = config["estimator"], AT[friction][which]
    record = reference(p)
    adjusted = {"motor.epsilon": {"fixed": EPSILON}} if friction == "coulomb_stribeck" else {}
    model = compose(ESEA(), config["effects"], adjusted)
    values = {f"motor.{name}": value for name, value in p.items()}
    steps = estimator.get("substeps")
    made = simulate(model, values, record, np.zeros(len(model.states)), steps, estimator["integrator"])
    error = np.sqrt(np.mean((made.outputs - record.outputs) ** 2)) / record.outputs.std()
    assert record.outputs.std() > 1.0
    assert error < ALLOWED, f"{friction}: {error:.2g}"
