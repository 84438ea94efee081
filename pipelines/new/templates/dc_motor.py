"""A DC motor driven by a voltage, whose speed is measured."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SPEED = 100.0  # rad/s, exceeded 5 % of the time
ACCELERATION = 500.0  # rad/s², exceeded 5 % of the time
VOLTAGE = 12.0  # V, exceeded 5 % of the time
CONSTANT = 0.7 * VOLTAGE / SPEED  # V·s/rad, of the torque and the back-EMF: as the data sheet says; set it
RESISTANCE = 1.0  # Ω, of the winding: as the data sheet says; set it
TORQUE = CONSTANT * VOLTAGE / RESISTANCE  # N·m, at stall
INERTIA = TORQUE / ACCELERATION  # kg·m², its order of magnitude
TURN = SPEED**2 / ACCELERATION  # rad, over which it gains its speed


class DCMotor(Plant):
    """``J w' = k (voltage - k w) / R - F``: whatever resists at the bearing is F.

    The inductance of the winding is left out: its time constant L/R is short. No torque is measured, so k and
    R are known: all torques are in proportion to k/R, and the back-EMF acts as a viscous friction k²/R does.
    The angle is an input, made of the measured speed, for effects that act at an angle.
    """

    name = "dc_motor"
    meaning = "a DC motor driven by a voltage, its speed measured"
    source = "template dc_motor of hybridid"
    states = (State("w", "rad/s", scale=SPEED, observed_by="speed", derivative=0, meaning="speed"),)
    inputs = (Signal("voltage", "V", "voltage at the motor"), Signal("angle", "rad", "angle turned"))
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
        Parameter("k", "V·s/rad", guess=CONSTANT, fixed=True, meaning="constant of torque and back-EMF"),
        Parameter("R", "Ω", guess=RESISTANCE, fixed=True, meaning="resistance of the winding"),
    )
    ports = (
        Port(
            "bearing",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 10,
            position_unit="rad",
            position_scale=TURN,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="bearings, brushes, gear, air",
            drive="torque of the motor",
        ),
        Port("voltage", "input", effort_unit="V", effort_scale=VOLTAGE, meaning="amplifier"),
        Port("speed", "output", effort_unit="rad/s", effort_scale=SPEED, meaning="tachometer"),
    )

    def motor(self, x, u, p):
        """Torque of the motor."""
        return p.k * (u.voltage - p.k * x.w) / p.R

    def motion(self, x, u, p):
        return {"bearing": Motion(position=u.angle, velocity=x.w)}

    def loads(self, x, u, p):
        return {"bearing": Load(drive=self.motor(x, u, p))}

    def derivative(self, x, u, p, effort):
        return {"w": (self.motor(x, u, p) - effort["bearing"]) / p.J}

    def output(self, x, u, p):
        return {"speed": x.w}
