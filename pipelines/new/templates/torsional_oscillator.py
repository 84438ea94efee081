"""An inertia on a torsional spring, driven by a torque."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SWING = 0.2  # rad, half the range of the angle
SPEED = 2.0  # rad/s, exceeded 5 % of the time
TORQUE = 1.0  # N·m, exceeded 5 % of the time
INERTIA = TORQUE * SWING / SPEED**2  # kg·m², the order of magnitude of J
STIFFNESS = TORQUE / SWING  # N·m/rad, the order of magnitude of K


class TorsionalOscillator(Plant):
    """``J q'' + K q = torque - F``: whatever resists beside the spring is F."""

    name = "torsional_oscillator"
    meaning = "an inertia on a torsional spring, driven by a torque"
    source = "template torsional_oscillator of hybridid"
    states = (
        State("q", "rad", scale=SWING, observed_by="angle", derivative=0, meaning="angle"),
        State("w", "rad/s", scale=SPEED, observed_by="angle", derivative=1, meaning="angular velocity"),
    )
    inputs = (Signal("torque", "N·m", "torque on the inertia"),)
    outputs = (Signal("angle", "rad", "angle from rest"),)
    parameters = (
        Parameter("J", "kg·m²", guess=INERTIA, lower=INERTIA / 1000, upper=1000 * INERTIA, meaning="inertia"),
        Parameter(
            "K",
            "N·m/rad",
            guess=STIFFNESS,
            lower=STIFFNESS / 1000,
            upper=1000 * STIFFNESS,
            meaning="stiffness",
        ),
    )
    ports = (
        Port(
            "spring",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 5,
            position_unit="rad",
            position_scale=SWING,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between inertia and ground: spring, damper, bearing",
            drive="torque on the inertia",
            load="torque of the spring",
        ),
        Port("torque", "input", effort_unit="N·m", effort_scale=TORQUE, meaning="motor or actuator"),
        Port("angle", "output", effort_unit="rad", effort_scale=SWING, meaning="encoder"),
    )

    def motion(self, x, u, p):
        return {"spring": Motion(position=x.q, velocity=x.w)}

    def loads(self, x, u, p):
        return {"spring": Load(drive=u.torque, load=-p.K * x.q)}

    def derivative(self, x, u, p, effort):
        return {"q": x.w, "w": (u.torque - p.K * x.q - effort["spring"]) / p.J}

    def output(self, x, u, p):
        return {"angle": x.q}
