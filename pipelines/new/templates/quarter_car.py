"""A quarter of a car: body and wheel over a road."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Motion, Plant

BODY = 300.0  # kg, sprung mass of this corner: weigh it
ROAD = 0.05  # m, exceeded 5 % of the time
STROKE = 0.05  # m, half the range of body − wheel
BODY_SPEED = 0.3  # m/s, exceeded 5 % of the time
WHEEL_SPEED = 1.0  # m/s, exceeded 5 % of the time


class QuarterCar(Plant):
    """``m_s z_s'' = -k_s (z_s - z_u) - F_s``, ``m_u z_u'' = k_s (z_s - z_u) + F_s - k_t (z_u - z_r) - F_t``.

    F_s is what acts between body and wheel beside the spring, F_t between wheel and road. No force is
    measured, so all masses and stiffnesses share one scale: m_s is known.
    """

    name = "quarter_car"
    meaning = "a quarter of a car: body and wheel over a road"
    source = "template quarter_car of hybridid"
    states = (
        State("z_s", "m", scale=ROAD, observed_by="body", derivative=0, meaning="body from rest"),
        State(
            "v_s", "m/s", scale=BODY_SPEED, observed_by="body", derivative=1, meaning="velocity of the body"
        ),
        State("z_u", "m", scale=ROAD, observed_by="wheel", derivative=0, meaning="wheel from rest"),
        State(
            "v_u",
            "m/s",
            scale=WHEEL_SPEED,
            observed_by="wheel",
            derivative=1,
            meaning="velocity of the wheel",
        ),
    )
    inputs = (Signal("road", "m", "height of the road under the wheel"),)
    outputs = (
        Signal("body", "m", "height of the body from rest"),
        Signal("wheel", "m", "height of the wheel from rest"),
    )
    parameters = (
        Parameter("m_s", "kg", guess=BODY, fixed=True, meaning="sprung mass"),
        Parameter("m_u", "kg", guess=BODY / 8, lower=BODY / 200, upper=BODY, meaning="unsprung mass"),
        Parameter("k_s", "N/m", guess=60 * BODY, lower=BODY, upper=3000 * BODY, meaning="suspension spring"),
        Parameter("k_t", "N/m", guess=600 * BODY, lower=10 * BODY, upper=30000 * BODY, meaning="tyre"),
    )
    ports = (
        Port(
            "suspension",
            "effort",
            effort_unit="N",
            effort_scale=10 * BODY * STROKE,
            position_unit="m",
            position_scale=STROKE,
            velocity_scale=WHEEL_SPEED,
            epsilon=WHEEL_SPEED / 500,
            meaning="between body and wheel: damper, bushings, stops",
            no_load="what the contact carries is the damper's own force",
        ),
        Port(
            "tyre",
            "effort",
            effort_unit="N",
            effort_scale=100 * BODY * ROAD,
            position_unit="m",
            position_scale=ROAD,
            velocity_scale=WHEEL_SPEED,
            epsilon=WHEEL_SPEED / 500,
            meaning="between wheel and road, over its deflection; its velocity is unknown",
            no_load="rubber that deflects: nothing slides",
        ),
        Port("road", "input", effort_unit="m", effort_scale=ROAD, meaning="road or test rig"),
        Port("body", "output", effort_unit="m", effort_scale=ROAD, meaning="sensor at the body"),
        Port("wheel", "output", effort_unit="m", effort_scale=ROAD, meaning="sensor at the wheel"),
    )

    def motion(self, x, u, p):
        return {
            "suspension": Motion(position=x.z_s - x.z_u, velocity=x.v_s - x.v_u),
            "tyre": Motion(position=x.z_u - u.road, velocity=0 * x.v_u),
        }

    def derivative(self, x, u, p, effort):
        strut = p.k_s * (x.z_s - x.z_u) + effort["suspension"]
        tyre = p.k_t * (x.z_u - u.road) + effort["tyre"]
        return {"z_s": x.v_s, "v_s": -strut / p.m_s, "z_u": x.v_u, "v_u": (strut - tyre) / p.m_u}

    def output(self, x, u, p):
        return {"body": x.z_s, "wheel": x.z_u}
