"""A mass on a guide, driven by a force."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

STROKE = 0.1  # m, half the range of the position
SPEED = 0.5  # m/s, exceeded 5 % of the time
FORCE = 10.0  # N, exceeded 5 % of the time
MASS = FORCE * STROKE / SPEED**2  # kg, its order of magnitude: a usual force over a usual acceleration


class Carriage(Plant):
    """``M q'' = force - F``: whatever resists at the guide is F."""

    name = "carriage"
    meaning = "a mass on a guide, driven by a force"
    source = "template carriage of hybridid"
    states = (
        State("q", "m", scale=STROKE, observed_by="position", derivative=0, meaning="position"),
        State("v", "m/s", scale=SPEED, observed_by="position", derivative=1, meaning="velocity"),
    )
    inputs = (Signal("force", "N", "force of the drive"),)
    outputs = (Signal("position", "m", "position on the guide"),)
    parameters = (
        Parameter("M", "kg", guess=MASS, lower=MASS / 100, upper=100 * MASS, meaning="moving mass"),
    )
    ports = (
        Port(
            "guide",
            "effort",
            effort_unit="N",
            effort_scale=FORCE / 5,
            position_unit="m",
            position_scale=STROKE,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between mass and ground: guide, screw, bearings",
            drive="force of the drive",
        ),
        Port("force", "input", effort_unit="N", effort_scale=FORCE, meaning="amplifier and drive"),
        Port("position", "output", effort_unit="m", effort_scale=STROKE, meaning="position sensor"),
    )

    def motion(self, x, u, p):
        return {"guide": Motion(position=x.q, velocity=x.v)}

    def loads(self, x, u, p):
        return {"guide": Load(drive=u.force)}

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": (u.force - effort["guide"]) / p.M}

    def output(self, x, u, p):
        return {"position": x.q}
