"""A position-controlled servo with a gear that swings a pendulum."""

from __future__ import annotations

from math import pi
from typing import final

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s²]."""
FIRMWARE = 4096 / (2 * pi * 256 * 885)
"""Duty per unit of ``kp`` and radian of error [1/rad]: 4096 counts a turn, kp in 1/256, 885 for full duty."""
ROUNDING = 1e-3
"""Rounding of the duty's limits: the duty differs from the sharp law by half of it at most."""


@final
class Servo(Plant):
    """``(J + m l²) q'' = tau - m g l sin(q) - F``: a pendulum on a servo's output shaft.

        duty = clamp(kp e (goal - position), ±1)        e = 4096 / (2π · 256 · 885) 1/rad
        tau  = enabled k_t (supply duty - k_t q') / (R - R_s (1 - duty²))
        position = q + q_0

    q is zero where the pendulum hangs down. J is the motor's inertia, seen at the output. The firmware sees
    its own encoder, so it closes the loop over ``position``. kp and the supply are inputs because they differ
    from one recording to the next. ``enabled`` is 1 or 0: without torque the bridge is open, and the
    back-EMF brakes nothing.

    R is the resistance at full duty, of the winding and of what feeds it; R_s is the feeding side's part. It
    carries the current for a share ``duty`` of the time only, so it counts with duty². With R_s = 0 this is
    the publishers' motor, whose torque is proportional to the duty.

    Torque and back-EMF determine k_t/R and k_t²/R alone, and the second acts as a viscous friction does: a
    fit of k_t, R and f_v together is nearly singular (correlation of k_t and R 0.996 in the publishers'
    data). R is therefore fixed at the manufacturer's stall current, 5 V / 1.47 A; f_v takes what the
    back-EMF does not explain, and k_t is on the scale that R sets. The publishers allow R 2 to 5 Ω.

    The contact at ``joint`` is the gear: the motor's torque drives it, the weight of the pendulum loads it.

    Source: Duclusaud, Passault, Padois, Ly (2025), "Extended Friction Models for the Physics Simulation of
    Servo Actuators", IEEE ICRA, arXiv:2410.08650; ROBOTIS e-Manual, XL330-M288-T (stall torque and current);
    Erickson, Maksimović (2001), Fundamentals of Power Electronics, ch. 3 (resistance before a chopper).
    """

    name = "servo"
    meaning = "geared servo under its firmware's position control, swinging a pendulum"
    source = "Duclusaud, Passault, Padois, Ly (2025), Extended Friction Models"
    states = (
        State("q", "rad", scale=0.5, observed_by="position", derivative=0, meaning="angle from hanging down"),
        State("v", "rad/s", scale=2.0, observed_by="position", derivative=1, meaning="angular velocity"),
    )
    inputs = (
        Signal("goal", "rad", "commanded angle"),
        Signal("kp", "1", "proportional gain of the firmware, in its own units"),
        Signal("supply", "V", "supply voltage"),
        Signal("enabled", "1", "1: torque on, 0: torque off"),
    )
    outputs = (Signal("position", "rad", "angle, from the encoder"),)
    parameters = (
        Parameter("m", "kg", guess=0.49, fixed=True, meaning="mass of the pendulum's bob"),
        Parameter("l", "m", guess=0.1, fixed=True, meaning="from the shaft to the bob"),
        Parameter("J", "kg·m²", guess=2e-3, lower=1e-4, upper=5e-2, meaning="motor inertia, at the output"),
        Parameter("k_t", "N·m/A", guess=0.35, lower=0.1, upper=3.0, meaning="torque constant, at the output"),
        Parameter("R", "Ω", guess=3.4, fixed=True, meaning="resistance at full duty"),
        Parameter("R_s", "Ω", guess=0.5, lower=0.0, upper=2.4, meaning="part of R before the bridge"),
        Parameter("q_0", "rad", guess=0.0, lower=-0.1, upper=0.1, scale=0.01, meaning="zero of the encoder"),
    )
    ports = (
        Port(
            "joint",
            "effort",
            effort_unit="N·m",
            effort_scale=0.1,
            position_unit="rad",
            position_scale=0.5,
            velocity_scale=2.0,
            epsilon=0.02,
            meaning="between output shaft and housing: gear, bearings, brushes",
            drive="motor torque through the gear",
            load="weight of the pendulum",
        ),
        Port("goal", "input", effort_unit="rad", effort_scale=1.0, meaning="commanded angle to firmware"),
        Port("position", "output", effort_unit="rad", effort_scale=0.5, meaning="encoder"),
    )

    def motion(self, x, u, p):
        return {"joint": Motion(position=x.q, velocity=x.v)}

    def loads(self, x, u, p):
        return {"joint": Load(drive=self._motor(x, u, p), load=self._weight(x, p))}

    def derivative(self, x, u, p, effort):
        torque = self._motor(x, u, p) + self._weight(x, p) - effort["joint"]
        return {"q": x.v, "v": torque / (p.J + p.m * p.l**2)}

    def output(self, x, u, p):
        return {"position": x.q + p.q_0}

    @staticmethod
    def _motor(x, u, p):
        """Torque of the motor at the output shaft [N·m]."""
        duty = _clamped(u.kp * FIRMWARE * (u.goal - x.q - p.q_0))
        resistance = p.R - p.R_s * (1 - duty**2)
        return u.enabled * p.k_t * (u.supply * duty - p.k_t * x.v) / resistance

    @staticmethod
    def _weight(x, p):
        """Torque of the pendulum's weight in the direction of q [N·m]."""
        return -p.m * GRAVITY * p.l * ca.sin(x.q)


def _clamped(duty):
    """``duty`` clipped to ±1, its corners rounded: within ROUNDING / 2 of the sharp law everywhere."""
    return 0.5 * (ca.sqrt((duty + 1) ** 2 + ROUNDING**2) - ca.sqrt((duty - 1) ** 2 + ROUNDING**2))
