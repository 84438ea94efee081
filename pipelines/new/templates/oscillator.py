"""A mass on a spring, driven by a force."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

STROKE = 0.01  # m, half the range of the displacement
SPEED = 0.1  # m/s, exceeded 5 % of the time
FORCE = 10.0  # N, exceeded 5 % of the time
MASS = FORCE * STROKE / SPEED**2  # kg, the order of magnitude of M
STIFFNESS = FORCE / STROKE  # N/m, the order of magnitude of K


class Oscillator(Plant):
    """``M q'' + K q = force - F``: whatever resists beside the spring is F."""

    name = "oscillator"
    meaning = "a mass on a spring, driven by a force"
    source = "template oscillator of hybridid"
    states = (
        State("q", "m", scale=STROKE, observed_by="displacement", derivative=0, meaning="displacement"),
        State("v", "m/s", scale=SPEED, observed_by="displacement", derivative=1, meaning="velocity"),
    )
    inputs = (Signal("force", "N", "force on the mass"),)
    outputs = (Signal("displacement", "m", "displacement from rest"),)
    parameters = (
        Parameter("M", "kg", guess=MASS, lower=MASS / 1000, upper=1000 * MASS, meaning="mass"),
        Parameter(
            "K", "N/m", guess=STIFFNESS, lower=STIFFNESS / 1000, upper=1000 * STIFFNESS, meaning="stiffness"
        ),
    )
    ports = (
        Port(
            "spring",
            "effort",
            effort_unit="N",
            effort_scale=FORCE / 5,
            position_unit="m",
            position_scale=STROKE,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between mass and ground: spring, damper, guide",
            drive="force on the mass",
            load="force of the spring",
        ),
        Port("force", "input", effort_unit="N", effort_scale=FORCE, meaning="shaker or actuator"),
        Port("displacement", "output", effort_unit="m", effort_scale=STROKE, meaning="displacement sensor"),
    )

    def motion(self, x, u, p):
        return {"spring": Motion(position=x.q, velocity=x.v)}

    def loads(self, x, u, p):
        return {"spring": Load(drive=u.force, load=-p.K * x.q)}

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": (u.force - p.K * x.q - effort["spring"]) / p.M}

    def output(self, x, u, p):
        return {"displacement": x.q}
