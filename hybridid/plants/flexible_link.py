"""The rotary flexible link: a geared DC motor turns the foot of a flexible beam."""

from __future__ import annotations

from typing import final

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant


@final
class FlexibleLink(Plant):
    """Servo angle theta and beam deflection alpha (tip angle minus servo angle), driven by a voltage.

        J_eq theta''            = tau + K_s alpha - F_servo + F_link
        J_l (theta'' + alpha'') = -K_s alpha - F_link
        tau = eta_g eta_m K_g k_t (V - K_g k_m theta') / R_m

    The beam has one mode: a rigid link of inertia J_l on a spring K_s. F_link resists the deflection and
    drives the servo. F_servo resists the servo. The motor's constants are the manufacturer's and fixed, so
    the inertias and the stiffness are estimated in SI units. The back-EMF brakes as a viscous friction of
    eta_g eta_m K_g² k_t k_m / R_m = 0.056 N·m·s/rad does.

    Source: Quanser, manuals of the Rotary Flexible Link and of its servo, the SRV02.
    """

    name = "flexible_link"
    meaning = "rotary flexible link: geared motor, flexible beam"
    source = "Quanser, Rotary Flexible Link and SRV02 user manuals"
    states = (
        State("theta", "rad", scale=0.5, observed_by="servo_angle", derivative=0, meaning="servo angle"),
        State(
            "theta_dot", "rad/s", scale=3.0, observed_by="servo_angle", derivative=1, meaning="servo velocity"
        ),
        State("alpha", "rad", scale=0.1, observed_by="tip_angle", derivative=0, meaning="beam deflection"),
        State("alpha_dot", "rad/s", scale=2.0, observed_by="tip_angle", derivative=1, meaning="its rate"),
    )
    inputs = (Signal("voltage", "V", "motor voltage"),)
    outputs = (
        Signal("servo_angle", "rad", "servo angle, from its encoder"),
        Signal("tip_angle", "rad", "beam deflection at the tip, from its strain gauge"),
    )
    parameters = (
        Parameter("J_eq", "kg·m²", guess=0.00208, lower=2e-4, upper=0.02, meaning="servo inertia, load side"),
        Parameter(
            "J_l", "kg·m²", guess=0.0038, lower=2e-4, upper=0.04, meaning="link inertia about the servo"
        ),
        Parameter("K_s", "N·m/rad", guess=1.3, lower=0.1, upper=20.0, meaning="stiffness of the beam"),
        Parameter("eta_g", "1", guess=0.9, lower=0.1, upper=1.0, fixed=True, meaning="gearbox efficiency"),
        Parameter("eta_m", "1", guess=0.69, lower=0.1, upper=1.0, fixed=True, meaning="motor efficiency"),
        Parameter("K_g", "1", guess=70.0, fixed=True, meaning="gear ratio"),
        Parameter("k_t", "N·m/A", guess=7.68e-3, fixed=True, meaning="torque constant"),
        Parameter("k_m", "V·s/rad", guess=7.68e-3, fixed=True, meaning="back-EMF constant"),
        Parameter("R_m", "Ω", guess=2.6, fixed=True, meaning="armature resistance"),
    )
    ports = (
        Port(
            "servo",
            "effort",
            effort_unit="N·m",
            effort_scale=0.1,
            position_unit="rad",
            position_scale=0.5,
            velocity_scale=3.0,
            epsilon=0.01,
            meaning="between servo and ground: gearbox, bearings",
            drive="motor torque through the gearbox",
            load="torque of the beam on the servo",
        ),
        Port(
            "link",
            "effort",
            effort_unit="N·m",
            effort_scale=0.1,
            position_unit="rad",
            position_scale=0.1,
            velocity_scale=2.0,
            epsilon=0.01,
            meaning="across the beam, between servo and tip",
            no_load="a beam that bends: nothing slides",
        ),
        Port("voltage", "input", effort_unit="V", effort_scale=2.0, meaning="command to motor voltage"),
        Port("servo_angle", "output", effort_unit="rad", effort_scale=0.5, meaning="encoder"),
        Port("tip_angle", "output", effort_unit="rad", effort_scale=0.1, meaning="strain gauge"),
    )

    def motion(self, x, u, p):
        return {
            "servo": Motion(position=x.theta, velocity=x.theta_dot),
            "link": Motion(position=x.alpha, velocity=x.alpha_dot),
        }

    def loads(self, x, u, p):
        return {"servo": Load(drive=self._torque(x, u, p), load=p.K_s * x.alpha)}

    def derivative(self, x, u, p, effort):
        torque = self._torque(x, u, p)
        beam = p.K_s * x.alpha + effort["link"]
        acceleration = (torque + beam - effort["servo"]) / p.J_eq
        return {
            "theta": x.theta_dot,
            "theta_dot": acceleration,
            "alpha": x.alpha_dot,
            "alpha_dot": -beam / p.J_l - acceleration,
        }

    @staticmethod
    def _torque(x, u, p):
        """tau: what the motor gives to the servo after the back-EMF, in N·m."""
        gain = p.eta_g * p.eta_m * p.K_g * p.k_t / p.R_m
        return gain * (u.voltage - p.K_g * p.k_m * x.theta_dot)

    def output(self, x, u, p):
        return {"servo_angle": x.theta, "tip_angle": x.alpha}
