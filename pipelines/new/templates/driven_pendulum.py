"""A pendulum, driven by a torque: an arm that gravity pulls down."""

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SWING = 1.0  # rad, half the range of the angle
SPEED = 3.0  # rad/s, exceeded 5 % of the time
TORQUE = 1.0  # N·m, exceeded 5 % of the time
INERTIA = TORQUE * SWING / SPEED**2  # kg·m², its order of magnitude: a usual torque over a usual acceleration


class DrivenPendulum(Plant):
    """``J q'' = torque - G sin(q - q_0) - F``: whatever resists at the joint is F."""

    name = "driven_pendulum"
    meaning = "a pendulum, driven by a torque"
    source = "template driven_pendulum of hybridid"
    states = (
        State("q", "rad", scale=SWING, observed_by="angle", derivative=0, meaning="angle"),
        State("w", "rad/s", scale=SPEED, observed_by="angle", derivative=1, meaning="angular velocity"),
    )
    inputs = (Signal("torque", "N·m", "torque of the drive"),)
    outputs = (Signal("angle", "rad", "angle of the pendulum"),)
    parameters = (
        Parameter("J", "kg·m²", guess=INERTIA, lower=INERTIA / 100, upper=100 * INERTIA, meaning="inertia"),
        Parameter("G", "N·m", guess=TORQUE, lower=0.0, upper=100 * TORQUE, meaning="m g l"),
        Parameter("q_0", "rad", guess=0.0, lower=-3.2, upper=3.2, scale=0.01, meaning="angle where it hangs"),
    )
    ports = (
        Port(
            "joint",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 5,
            position_unit="rad",
            position_scale=SWING,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between shaft and housing: bearings, gear, brushes",
            drive="torque of the drive",
            load="weight of the pendulum",
        ),
        Port("torque", "input", effort_unit="N·m", effort_scale=TORQUE, meaning="amplifier and motor"),
        Port("angle", "output", effort_unit="rad", effort_scale=SWING, meaning="encoder"),
    )

    def motion(self, x, u, p):
        return {"joint": Motion(position=x.q, velocity=x.w)}

    def loads(self, x, u, p):
        return {"joint": Load(drive=u.torque, load=-p.G * ca.sin(x.q - p.q_0))}

    def derivative(self, x, u, p, effort):
        return {"q": x.w, "w": (u.torque - p.G * ca.sin(x.q - p.q_0) - effort["joint"]) / p.J}

    def output(self, x, u, p):
        return {"angle": x.q}
