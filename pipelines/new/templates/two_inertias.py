"""A motor and a link, with a spring between them."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SWING = 1.0  # rad, half the range of the motor's angle
SPEED = 3.0  # rad/s, of the motor, exceeded 5 % of the time
LINK_SPEED = 3.0  # rad/s, of the link, exceeded 5 % of the time
TORQUE = 1.0  # N·m, exceeded 5 % of the time
TWIST = 0.1  # rad, half the range of the angle between the two
INERTIA = TORQUE * SWING / SPEED**2  # kg·m², the order of magnitude of both
STIFFNESS = TORQUE / TWIST  # N·m/rad, the order of magnitude of K


class TwoInertias(Plant):
    """``J q_m'' = torque - K (q_m - q_l) - F_m - F_s``, ``I q_l'' = K (q_m - q_l) + F_s - F_l``.

    F_m resists at the motor, F_l at the link, F_s the twist of the spring.
    """

    name = "two_inertias"
    meaning = "a motor and a link, with a spring between them"
    source = "template two_inertias of hybridid"
    states = (
        State("q_m", "rad", scale=SWING, observed_by="motor_angle", derivative=0, meaning="motor angle"),
        State("w_m", "rad/s", scale=SPEED, observed_by="motor_angle", derivative=1, meaning="motor speed"),
        State("q_l", "rad", scale=SWING, observed_by="link_angle", derivative=0, meaning="link angle"),
        State("w_l", "rad/s", scale=LINK_SPEED, observed_by="link_angle", derivative=1, meaning="link speed"),
    )
    inputs = (Signal("torque", "N·m", "torque of the motor"),)
    outputs = (
        Signal("motor_angle", "rad", "angle of the motor"),
        Signal("link_angle", "rad", "angle of the link"),
    )
    parameters = (
        Parameter("J", "kg·m²", guess=INERTIA, lower=INERTIA / 1000, upper=100 * INERTIA, meaning="motor"),
        Parameter("I", "kg·m²", guess=INERTIA, lower=INERTIA / 1000, upper=100 * INERTIA, meaning="link"),
        Parameter(
            "K", "N·m/rad", guess=STIFFNESS, lower=STIFFNESS / 1000, upper=1000 * STIFFNESS, meaning="spring"
        ),
    )
    ports = (
        Port(
            "motor",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 5,
            position_unit="rad",
            position_scale=SWING,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between motor and housing: bearings, gear, brushes",
            drive="torque of the motor",
            load="torque of the spring on the motor",
        ),
        Port(
            "link",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 5,
            position_unit="rad",
            position_scale=SWING,
            velocity_scale=LINK_SPEED,
            epsilon=LINK_SPEED / 500,
            meaning="between link and housing: bearings, air",
            drive="torque of the spring on the link",
        ),
        Port(
            "spring",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 5,
            position_unit="rad",
            position_scale=TWIST,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="in the spring, over its twist",
            no_load="it twists, and nothing slides",
        ),
        Port("torque", "input", effort_unit="N·m", effort_scale=TORQUE, meaning="amplifier and motor"),
        Port("motor_angle", "output", effort_unit="rad", effort_scale=SWING, meaning="encoder of the motor"),
        Port("link_angle", "output", effort_unit="rad", effort_scale=SWING, meaning="encoder of the link"),
    )

    def motion(self, x, u, p):
        return {
            "motor": Motion(position=x.q_m, velocity=x.w_m),
            "link": Motion(position=x.q_l, velocity=x.w_l),
            "spring": Motion(position=x.q_m - x.q_l, velocity=x.w_m - x.w_l),
        }

    def loads(self, x, u, p):
        twist = p.K * (x.q_m - x.q_l)
        return {"motor": Load(drive=u.torque, load=-twist), "link": Load(drive=twist)}

    def derivative(self, x, u, p, effort):
        across = p.K * (x.q_m - x.q_l) + effort["spring"]
        return {
            "q_m": x.w_m,
            "w_m": (u.torque - across - effort["motor"]) / p.J,
            "q_l": x.w_l,
            "w_l": (across - effort["link"]) / p.I,
        }

    def output(self, x, u, p):
        return {"motor_angle": x.q_m, "link_angle": x.q_l}
