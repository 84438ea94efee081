"""An inertia whose speed is measured: a spindle, a wheel, a motor with a tachometer."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SPEED = 5.0  # rad/s, exceeded 5 % of the time
ACCELERATION = 1.0  # rad/s², exceeded 5 % of the time
TORQUE = 1.0  # N·m, exceeded 5 % of the time
INERTIA = TORQUE / ACCELERATION  # kg·m², its order of magnitude
TURN = SPEED**2 / ACCELERATION  # rad, over which it gains its speed


class Spindle(Plant):
    """``J w' = torque - F``: whatever resists at the bearing is F.

    The angle is an input, made of the measured speed, for effects that act at an angle.
    """

    name = "spindle"
    meaning = "an inertia whose speed is measured, driven by a torque"
    source = "template spindle of hybridid"
    states = (State("w", "rad/s", scale=SPEED, observed_by="speed", derivative=0, meaning="speed"),)
    inputs = (Signal("torque", "N·m", "torque of the drive"), Signal("angle", "rad", "angle turned"))
    outputs = (Signal("speed", "rad/s", "speed"),)
    parameters = (
        Parameter(
            "J",
            "kg·m²",
            guess=INERTIA,
            lower=INERTIA / 100,
            upper=100 * INERTIA,
            meaning="inertia of all that turns",
        ),
    )
    ports = (
        Port(
            "bearing",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 5,
            position_unit="rad",
            position_scale=TURN,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="bearings, seals, air",
            drive="torque of the drive",
        ),
        Port("torque", "input", effort_unit="N·m", effort_scale=TORQUE, meaning="amplifier and drive"),
        Port("speed", "output", effort_unit="rad/s", effort_scale=SPEED, meaning="speed sensor"),
    )

    def motion(self, x, u, p):
        return {"bearing": Motion(position=u.angle, velocity=x.w)}

    def loads(self, x, u, p):
        return {"bearing": Load(drive=u.torque)}

    def derivative(self, x, u, p, effort):
        return {"w": (u.torque - effort["bearing"]) / p.J}

    def output(self, x, u, p):
        return {"speed": x.w}
