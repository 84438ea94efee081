"""A pendulum that swings freely: no input."""

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SWING = 0.5  # rad, half the range of the angle
SPEED = 2.0  # rad/s, exceeded 5 % of the time
J = 1.0  # kg·m², about the pivot; left at 1 kg·m², all torques are per unit of inertia
PULL = J * (SPEED / SWING) ** 2  # N·m, the order of magnitude of G


class Pendulum(Plant):
    """``J q'' + G sin(q - q_0) = -F``: whatever resists at the pivot is F.

    A free swing tells G and F only over J. So J is known, or 1.
    """

    name = "pendulum"
    meaning = "a pendulum that swings freely"
    source = "template pendulum of hybridid"
    states = (
        State("q", "rad", scale=SWING, observed_by="angle", derivative=0, meaning="angle"),
        State("w", "rad/s", scale=SPEED, observed_by="angle", derivative=1, meaning="angular velocity"),
    )
    inputs = ()
    outputs = (Signal("angle", "rad", "angle of the pendulum"),)
    parameters = (
        Parameter("J", "kg·m²", guess=J, fixed=True, meaning="inertia about the pivot"),
        Parameter("G", "N·m", guess=PULL, lower=PULL / 100, upper=100 * PULL, meaning="m g l"),
        Parameter("q_0", "rad", guess=0.0, lower=-1.0, upper=1.0, scale=0.01, meaning="angle where it hangs"),
    )
    ports = (
        Port(
            "pivot",
            "effort",
            effort_unit="N·m",
            effort_scale=0.02 * PULL * SWING,
            position_unit="rad",
            position_scale=SWING,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between pendulum and frame: bearing, air",
            load="weight of the pendulum",
        ),
        Port("angle", "output", effort_unit="rad", effort_scale=SWING, meaning="encoder"),
    )

    def motion(self, x, u, p):
        return {"pivot": Motion(position=x.q, velocity=x.w)}

    def loads(self, x, u, p):
        return {"pivot": Load(load=-p.G * ca.sin(x.q - p.q_0))}

    def derivative(self, x, u, p, effort):
        return {"q": x.w, "w": (-p.G * ca.sin(x.q - p.q_0) - effort["pivot"]) / p.J}

    def output(self, x, u, p):
        return {"angle": x.q}
