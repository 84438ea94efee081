"""The half-car: a chassis that heaves and pitches on two axles."""

from __future__ import annotations

from typing import final

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Motion, Plant

_NO_SIDE_FORCE = (
    "the spring stands beside the damper; what presses the piston rod on its guide is a side force, which "
    "the plane model does not have"
)
_ROLLS = "a tyre bends and rolls: no contact slides along this coordinate"


def _strut(name: str, effort_scale: float, position_scale: float, meaning: str, no_load: str) -> Port:
    return Port(
        name,
        "effort",
        effort_unit="N",
        effort_scale=effort_scale,
        position_unit="m",
        position_scale=position_scale,
        velocity_scale=0.5,
        epsilon=5e-3,
        meaning=meaning,
        no_load=no_load,
    )


@final
class HalfCar(Plant):
    """Chassis (z_c, theta), front axle z_f and rear axle z_r over the road heights u_f and u_r.

        m_c z_c''    = F_f + F_r
        I_yy theta'' = l_r F_r - l_f F_f
        m_f z_f''    = k_t (u_f - z_f) + effort(front_tyre) - F_f      (rear alike)
        F_f = k_f d_f + c_f d_f' + effort(front_suspension),  d_f = z_f - (z_c - l_f theta)
        F_r = k_r d_r + c_r d_r' + effort(rear_suspension),   d_r = z_r - (z_c + l_r theta)

    Heights are measured upwards from the static equilibrium on a level road, where the springs
    carry the weight: gravity cancels in Eq. 4-14, and a car on a level road starts at rest at zero.
    theta > 0 lifts the rear. The deflection of a suspension or tyre is positive in compression. A positive
    effort there pushes its two ends apart and adds to the plant's own spring and damper.
    The rate of the road is not an input, so a tyre's velocity is unknown and taken as zero. Effects of
    position (a stiffening tyre, a wheel that lifts off) act there. Effects of velocity give zero.

    Source: thesis Eqs. 4-1 to 4-14, Tables 4.1 and 4.2; k_p of the equations and k_t of the tables are
    one tyre stiffness, I_yy is in kg·m² (printed kg·m⁴).
    """

    name = "half_car"
    meaning = "half-car: chassis, two suspensions, two axles, two tyres"
    source = "thesis Eqs. 4-1 to 4-14, Tables 4.1 and 4.2"
    states = (
        State(
            "z_c_dot", "m/s", scale=0.3, observed_by="vertical_velocity", meaning="chassis vertical velocity"
        ),
        State("theta_dot", "rad/s", scale=0.3, observed_by="pitch_rate", meaning="chassis pitch rate"),
        State("z_f_dot", "m/s", scale=0.5, meaning="front axle velocity"),
        State("z_r_dot", "m/s", scale=0.5, meaning="rear axle velocity"),
        State("z_c", "m", scale=0.05, meaning="chassis height above static equilibrium"),
        State("theta", "rad", scale=0.05, meaning="chassis pitch angle"),
        State("z_f", "m", scale=0.05, meaning="front axle height above static equilibrium"),
        State("z_r", "m", scale=0.05, meaning="rear axle height above static equilibrium"),
    )
    inputs = (
        Signal("u_f", "m", "road height under the front wheel"),
        Signal("u_r", "m", "road height under the rear wheel"),
    )
    outputs = (
        Signal("vertical_velocity", "m/s", "chassis vertical velocity, upwards"),
        Signal("pitch_rate", "rad/s", "chassis pitch rate, rear upwards"),
    )
    parameters = (
        Parameter("m_c", "kg", guess=1250.0, fixed=True, meaning="chassis mass"),
        Parameter("l_f", "m", guess=1.5, fixed=True, meaning="front axle to centre of gravity"),
        Parameter("l_r", "m", guess=1.6, fixed=True, meaning="rear axle to centre of gravity"),
        Parameter("m_f", "kg", guess=30.0, fixed=True, meaning="front axle mass"),
        Parameter("m_r", "kg", guess=30.0, fixed=True, meaning="rear axle mass"),
        Parameter(
            "I_yy", "kg·m²", guess=2000.0, lower=200.0, upper=2e4, meaning="pitch inertia of the chassis"
        ),
        Parameter("k_f", "N/m", guess=3e4, lower=1e3, upper=5e5, meaning="front suspension stiffness"),
        Parameter("k_r", "N/m", guess=3e4, lower=1e3, upper=5e5, meaning="rear suspension stiffness"),
        Parameter("c_f", "N·s/m", guess=2e3, lower=10.0, upper=5e4, meaning="front damping coefficient"),
        Parameter("c_r", "N·s/m", guess=2e3, lower=10.0, upper=5e4, meaning="rear damping coefficient"),
        Parameter("k_t", "N/m", guess=3e5, lower=2e4, upper=2e7, meaning="stiffness of a tyre"),
    )
    alike = (("front_suspension", "rear_suspension"), ("front_tyre", "rear_tyre"))
    ports = (
        _strut(
            "front_suspension", 2000.0, 0.05, "front spring and damper, compression positive", _NO_SIDE_FORCE
        ),
        _strut(
            "rear_suspension", 2000.0, 0.05, "rear spring and damper, compression positive", _NO_SIDE_FORCE
        ),
        _strut(
            "front_tyre", 5000.0, 0.02, "front tyre, compression positive; its velocity is unknown", _ROLLS
        ),
        _strut("rear_tyre", 5000.0, 0.02, "rear tyre, compression positive; its velocity is unknown", _ROLLS),
        Port("u_f", "input", effort_unit="m", effort_scale=0.05, meaning="road to front tyre"),
        Port("u_r", "input", effort_unit="m", effort_scale=0.05, meaning="road to rear tyre"),
        Port(
            "vertical_velocity",
            "output",
            effort_unit="m/s",
            effort_scale=0.3,
            meaning="accelerometer, integrated",
        ),
        Port("pitch_rate", "output", effort_unit="rad/s", effort_scale=0.3, meaning="rate gyro"),
    )

    def motion(self, x, u, p):
        front, rear = (x.z_c - p.l_f * x.theta), (x.z_c + p.l_r * x.theta)
        front_dot, rear_dot = (x.z_c_dot - p.l_f * x.theta_dot), (x.z_c_dot + p.l_r * x.theta_dot)
        return {
            "front_suspension": Motion(position=x.z_f - front, velocity=x.z_f_dot - front_dot),
            "rear_suspension": Motion(position=x.z_r - rear, velocity=x.z_r_dot - rear_dot),
            "front_tyre": Motion(position=u.u_f - x.z_f, velocity=0 * x.z_f_dot),
            "rear_tyre": Motion(position=u.u_r - x.z_r, velocity=0 * x.z_r_dot),
        }

    def derivative(self, x, u, p, effort):
        at = self.motion(x, u, p)
        front, rear = at["front_suspension"], at["rear_suspension"]
        force_f = p.k_f * front.position + p.c_f * front.velocity + effort["front_suspension"]
        force_r = p.k_r * rear.position + p.c_r * rear.velocity + effort["rear_suspension"]
        tyre_f = p.k_t * at["front_tyre"].position + effort["front_tyre"]
        tyre_r = p.k_t * at["rear_tyre"].position + effort["rear_tyre"]
        return {
            "z_c_dot": (force_f + force_r) / p.m_c,
            "theta_dot": (p.l_r * force_r - p.l_f * force_f) / p.I_yy,
            "z_f_dot": (tyre_f - force_f) / p.m_f,
            "z_r_dot": (tyre_r - force_r) / p.m_r,
            "z_c": x.z_c_dot,
            "theta": x.theta_dot,
            "z_f": x.z_f_dot,
            "z_r": x.z_r_dot,
        }

    def output(self, x, u, p):
        return {"vertical_velocity": x.z_c_dot, "pitch_rate": x.theta_dot}
