"""The elastomer-based series elastic actuator: a motor turns a link through a rubber joint."""

from __future__ import annotations

from typing import final

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant


@final
class ESEA(Plant):
    """Two inertias and an elastomer spring; effects act at ``motor``, ``elastomer`` and ``link``.

        J delta'' = torque - K_e (delta - theta) - F_motor - F_elastomer
        I theta'' = K_e (delta - theta) + F_elastomer - F_link

    delta is the motor's angle, theta the link's. The friction of the thesis, F_f(delta'), is an effect at
    ``motor``. F_elastomer resists the twist delta - theta: it brakes the motor and drives the link. A joint
    that stiffens, dissipates or has play is an effect at ``elastomer``. The inertias and the spring are
    known (fixed). A config that gives bounds, as ``parameters: {K_e: {lower: 4, upper: 16}}``, makes one
    free.

    Source: thesis Eqs. 5-1 to 5-4 and Table 5.1, whose I and J are in kg·m² (printed m⁴).
    """

    name = "esea"
    meaning = "elastomer-based series elastic actuator: motor, elastic joint, link"
    source = "thesis Eqs. 5-1 to 5-4, Table 5.1"
    states = (
        State("delta_dot", "rad/s", scale=5.0, meaning="motor velocity"),
        State("theta_dot", "rad/s", scale=5.0, observed_by="link_velocity", meaning="link velocity"),
        State("delta", "rad", scale=1.0, meaning="motor angle"),
        State("theta", "rad", scale=1.0, meaning="link angle"),
    )
    inputs = (Signal("torque", "N·m", "motor torque"),)
    outputs = (Signal("link_velocity", "rad/s", "link angular velocity"),)
    parameters = (
        Parameter("I", "kg·m²", guess=0.0014, fixed=True, meaning="link inertia about the joint"),
        Parameter("J", "kg·m²", guess=0.0001, fixed=True, meaning="motor inertia"),
        Parameter("K_e", "N·m/rad", guess=8.459, fixed=True, meaning="stiffness of the elastomer"),
    )
    ports = (
        Port(
            "motor",
            "effort",
            effort_unit="N·m",
            effort_scale=0.1,
            position_unit="rad",
            position_scale=1.0,
            velocity_scale=5.0,
            epsilon=0.03,
            meaning="motor bearings and brushes: the thesis' friction",
            drive="motor torque",
            load="torque of the elastomer on the motor",
        ),
        Port(
            "elastomer",
            "effort",
            effort_unit="N·m",
            effort_scale=0.1,
            position_unit="rad",
            position_scale=0.01,
            velocity_scale=0.3,
            epsilon=0.02,
            meaning="twist of the joint, motor angle minus link angle",
            no_load="bonded rubber: it shears, and nothing slides",
        ),
        Port(
            "link",
            "effort",
            effort_unit="N·m",
            effort_scale=0.1,
            position_unit="rad",
            position_scale=1.0,
            velocity_scale=5.0,
            epsilon=0.03,
            meaning="link bearing; the link's weight",
            drive="torque of the elastomer on the link",
        ),
        Port("torque", "input", effort_unit="N·m", effort_scale=0.1, meaning="torque command to torque"),
        Port("link_velocity", "output", effort_unit="rad/s", effort_scale=5.0, meaning="link encoder"),
    )

    def motion(self, x, u, p):
        return {
            "motor": Motion(position=x.delta, velocity=x.delta_dot),
            "elastomer": Motion(position=x.delta - x.theta, velocity=x.delta_dot - x.theta_dot),
            "link": Motion(position=x.theta, velocity=x.theta_dot),
        }

    def loads(self, x, u, p):
        joint = p.K_e * (x.delta - x.theta)
        return {"motor": Load(drive=u.torque, load=-joint), "link": Load(drive=joint)}

    def derivative(self, x, u, p, effort):
        joint = p.K_e * (x.delta - x.theta) + effort["elastomer"]
        return {
            "delta_dot": (u.torque - joint - effort["motor"]) / p.J,
            "theta_dot": (joint - effort["link"]) / p.I,
            "delta": x.delta_dot,
            "theta": x.theta_dot,
        }

    def output(self, x, u, p):
        return {"link_velocity": x.theta_dot}
