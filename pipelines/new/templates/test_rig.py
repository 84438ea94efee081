"""A test rig: it prescribes the motion of a specimen, and measures the force."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Motion, Plant

STROKE = 0.01  # m, half the range of the displacement
SPEED = 0.1  # m/s, exceeded 5 % of the time
FORCE = 100.0  # N, exceeded 5 % of the time
STIFFNESS = FORCE / STROKE  # N/m, the order of magnitude of K


class Specimen(Plant):
    """``force = M a + K q + F``: the inertia between specimen and load cell, a spring, and whatever resists.

    The motion is prescribed. So velocity and acceleration are inputs, made of the displacement.
    """

    name = "test_rig"
    meaning = "a test rig: motion prescribed, force measured"
    source = "template test_rig of hybridid"
    states = (
        State("q", "m", scale=STROKE, observed_by="displacement", derivative=0, meaning="displacement"),
    )
    inputs = (
        Signal("velocity", "m/s", "velocity of the rig"),
        Signal("acceleration", "m/s²", "acceleration"),
    )
    outputs = (Signal("displacement", "m", "displacement of the rig"), Signal("force", "N", "load cell"))
    parameters = (
        Parameter(
            "M",
            "kg",
            guess=0.1 * FORCE * STROKE / SPEED**2,
            lower=0.0,
            scale=0.1 * FORCE * STROKE / SPEED**2,
            meaning="moved mass",
        ),
        Parameter("K", "N/m", guess=STIFFNESS, lower=0.0, scale=STIFFNESS, meaning="stiffness"),
    )
    ports = (
        Port(
            "specimen",
            "effort",
            effort_unit="N",
            effort_scale=FORCE,
            position_unit="m",
            position_scale=STROKE,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="the specimen: damper, friction joint, bushing",
            no_load="the rig moves it, whatever the force",
        ),
        Port("force", "output", effort_unit="N", effort_scale=FORCE, meaning="load cell"),
    )

    def motion(self, x, u, p):
        return {"specimen": Motion(position=x.q, velocity=u.velocity, acceleration=u.acceleration)}

    def derivative(self, x, u, p, effort):
        return {"q": u.velocity}

    def output(self, x, u, p):
        return {"displacement": x.q}

    def sensed(self, x, u, p, effort):
        return {"force": p.M * u.acceleration + p.K * x.q + effort["specimen"]}
