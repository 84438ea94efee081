"""A servo: DC motor, gear, proportional control with a clamp, and a pendulum or an inertia."""

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

SWING = 1.0  # rad, half the range of the angle
SPEED = 3.0  # rad/s, exceeded 5 % of the time
GAIN = 4.0  # 1/rad, of the controller: share of the supply per rad of error; set it
SUPPLY = 12.0  # V; set it
RESISTANCE = 2.0  # Ω, of the winding: supply over stall current
CONSTANT = 0.5  # N·m/A, at the output: stall torque over stall current
TORQUE = CONSTANT * SUPPLY / RESISTANCE  # N·m, at stall
INERTIA = TORQUE * SWING / SPEED**2  # kg·m², the order of magnitude of J
ROUNDING = 1e-3  # of the corners of the clamp, as a share of the supply


class Servo(Plant):
    """``J q'' = k_t (U duty - k_t q') / (R - R_s (1 - duty²)) - G sin(q) - F``, with
    ``duty = clamp(k_p (goal - q), ±1)``.

    q is zero where the pendulum hangs; fix G at 0 where there is none. No torque is measured, and the
    back-EMF acts as a viscous friction does: so all torques share one scale, and k_t and R are known. R_s
    is the part of R before the bridge (leads, battery): it carries the current for a share of the time only.
    """

    name = "servo"
    meaning = "a servo under proportional control, swinging a pendulum"
    source = "template servo of hybridid"
    states = (
        State("q", "rad", scale=SWING, observed_by="angle", derivative=0, meaning="angle"),
        State("w", "rad/s", scale=SPEED, observed_by="angle", derivative=1, meaning="angular velocity"),
    )
    inputs = (Signal("goal", "rad", "commanded angle"),)
    outputs = (Signal("angle", "rad", "angle, from the encoder"),)
    parameters = (
        Parameter(
            "J", "kg·m²", guess=INERTIA, lower=INERTIA / 1000, upper=10 * INERTIA, meaning="at the output"
        ),
        Parameter("k_t", "N·m/A", guess=CONSTANT, fixed=True, meaning="torque constant at the output"),
        Parameter("R", "Ω", guess=RESISTANCE, fixed=True, meaning="resistance of the winding"),
        Parameter(
            "R_s",
            "Ω",
            guess=0.0,
            lower=0.0,
            upper=RESISTANCE,
            scale=RESISTANCE,
            fixed=True,
            meaning="of the supply",
        ),
        Parameter("k_p", "1/rad", guess=GAIN, fixed=True, meaning="gain of the controller"),
        Parameter("U", "V", guess=SUPPLY, fixed=True, meaning="supply voltage"),
        Parameter("G", "N·m", guess=TORQUE / 10, lower=0.0, upper=10 * TORQUE, meaning="m g l"),
    )
    ports = (
        Port(
            "joint",
            "effort",
            effort_unit="N·m",
            effort_scale=TORQUE / 5,
            position_unit="rad",
            position_scale=SWING,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="between shaft and housing: gear, bearings, brushes",
            drive="torque of the motor through the gear",
            load="weight of the pendulum",
        ),
        Port("goal", "input", effort_unit="rad", effort_scale=SWING, meaning="commanded angle"),
        Port("angle", "output", effort_unit="rad", effort_scale=SWING, meaning="encoder"),
    )

    def motor(self, x, u, p):
        """Torque of the motor at the output."""
        duty = clamped(p.k_p * (u.goal - x.q))
        return p.k_t * (p.U * duty - p.k_t * x.w) / (p.R - p.R_s * (1 - duty**2))

    def motion(self, x, u, p):
        return {"joint": Motion(position=x.q, velocity=x.w)}

    def loads(self, x, u, p):
        return {"joint": Load(drive=self.motor(x, u, p), load=-p.G * ca.sin(x.q))}

    def derivative(self, x, u, p, effort):
        return {"q": x.w, "w": (self.motor(x, u, p) - p.G * ca.sin(x.q) - effort["joint"]) / p.J}

    def output(self, x, u, p):
        return {"angle": x.q}


def clamped(share):
    """``share`` between -1 and 1, with rounded corners."""
    return 0.5 * (ca.sqrt((share + 1) ** 2 + ROUNDING**2) - ca.sqrt((share - 1) ** 2 + ROUNDING**2))
