"""A mass whose speed is measured: a vehicle, a carriage with a tachometer."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SPEED = 5.0  # m/s, exceeded 5 % of the time
ACCELERATION = 1.0  # m/s², exceeded 5 % of the time
FORCE = 100.0  # N, exceeded 5 % of the time
MASS = FORCE / ACCELERATION  # kg, its order of magnitude
WAY = SPEED**2 / ACCELERATION  # m, over which it gains its speed


class Vehicle(Plant):
    """``M v' = force - F``: whatever resists at the road is F.

    The distance is an input, made of the measured speed, for effects that act at a place.
    """

    name = "vehicle"
    meaning = "a mass whose speed is measured, driven by a force"
    source = "template vehicle of hybridid"
    states = (State("v", "m/s", scale=SPEED, observed_by="speed", derivative=0, meaning="speed"),)
    inputs = (Signal("force", "N", "force of the drive"), Signal("distance", "m", "distance gone"))
    outputs = (Signal("speed", "m/s", "speed"),)
    parameters = (
        Parameter("M", "kg", guess=MASS, lower=MASS / 100, upper=100 * MASS, meaning="moving mass"),
    )
    ports = (
        Port(
            "road",
            "effort",
            effort_unit="N",
            effort_scale=FORCE / 5,
            position_unit="m",
            position_scale=WAY,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between mass and ground: rolling, air, slope",
            drive="force of the drive",
        ),
        Port("force", "input", effort_unit="N", effort_scale=FORCE, meaning="amplifier and drive"),
        Port("speed", "output", effort_unit="m/s", effort_scale=SPEED, meaning="speed sensor"),
    )

    def motion(self, x, u, p):
        return {"road": Motion(position=u.distance, velocity=x.v)}

    def loads(self, x, u, p):
        return {"road": Load(drive=u.force)}

    def derivative(self, x, u, p, effort):
        return {"v": (u.force - effort["road"]) / p.M}

    def output(self, x, u, p):
        return {"speed": x.v}
