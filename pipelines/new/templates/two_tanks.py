"""Two tanks: a pump fills the upper one, which runs into the lower one."""

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

UPPER = 0.3  # m, level of the upper tank, exceeded 5 % of the time
LOWER = 0.3  # m, level of the lower tank, exceeded 5 % of the time
UPPER_RATE = 0.01  # m/s, rate of the upper level, exceeded 5 % of the time
LOWER_RATE = 0.01  # m/s, rate of the lower level, exceeded 5 % of the time
FLOW = 1e-4  # m³/s, exceeded 5 % of the time


class TwoTanks(Plant):
    """``A_1 h_1' = inflow - c_1 √h_1 - F_1``, ``A_2 h_2' = c_1 √h_1 - c_2 √h_2 - F_2``.

    F_1 and F_2 are whatever else leaves the tanks. What F_1 takes from the upper tank reaches the lower one
    with the effect overflow_into alone.
    """

    name = "two_tanks"
    meaning = "two tanks: a pump fills the upper one, which runs into the lower one"
    source = "template two_tanks of hybridid"
    states = (
        State("h_1", "m", scale=UPPER, observed_by="upper_level", derivative=0, meaning="upper level"),
        State("h_2", "m", scale=LOWER, observed_by="lower_level", derivative=0, meaning="lower level"),
    )
    inputs = (Signal("inflow", "m³/s", "flow of the pump"),)
    outputs = (
        Signal("upper_level", "m", "level of the upper tank over its outlet"),
        Signal("lower_level", "m", "level of the lower tank over its outlet"),
    )
    parameters = (
        Parameter(
            "A_1",
            "m²",
            guess=FLOW / UPPER_RATE,
            lower=FLOW / UPPER_RATE / 100,
            upper=100 * FLOW / UPPER_RATE,
            meaning="section of the upper tank",
        ),
        Parameter(
            "A_2",
            "m²",
            guess=FLOW / LOWER_RATE,
            lower=FLOW / LOWER_RATE / 100,
            upper=100 * FLOW / LOWER_RATE,
            meaning="section of the lower tank",
        ),
        Parameter(
            "c_1",
            "m^2.5/s",
            guess=FLOW / UPPER**0.5,
            lower=FLOW / UPPER**0.5 / 100,
            upper=100 * FLOW / UPPER**0.5,
            meaning="outlet of the upper tank",
        ),
        Parameter(
            "c_2",
            "m^2.5/s",
            guess=FLOW / LOWER**0.5,
            lower=FLOW / LOWER**0.5 / 100,
            upper=100 * FLOW / LOWER**0.5,
            meaning="outlet of the lower tank",
        ),
    )
    ports = (
        Port(
            "upper",
            "flow",
            effort_unit="m³/s",
            effort_scale=FLOW,
            position_unit="m",
            position_scale=UPPER,
            velocity_scale=UPPER_RATE,
            meaning="what else leaves the upper tank",
            drive="flow of the pump",
        ),
        Port(
            "lower",
            "flow",
            effort_unit="m³/s",
            effort_scale=FLOW,
            position_unit="m",
            position_scale=LOWER,
            velocity_scale=LOWER_RATE,
            meaning="what else leaves the lower tank",
        ),
        Port("inflow", "input", effort_unit="m³/s", effort_scale=FLOW, meaning="pump"),
        Port("upper_level", "output", effort_unit="m", effort_scale=UPPER, meaning="gauge of the upper tank"),
        Port("lower_level", "output", effort_unit="m", effort_scale=LOWER, meaning="gauge of the lower tank"),
    )

    def net_flows(self, x, u, p):
        """What enters each tank less what its outlet takes."""
        between = p.c_1 * ca.sqrt(ca.fmax(x.h_1, 1e-6 * UPPER))
        return u.inflow - between, between - p.c_2 * ca.sqrt(ca.fmax(x.h_2, 1e-6 * LOWER))

    def motion(self, x, u, p):
        upper, lower = self.net_flows(x, u, p)
        return {
            "upper": Motion(position=x.h_1, velocity=upper / p.A_1),
            "lower": Motion(position=x.h_2, velocity=lower / p.A_2),
        }

    def loads(self, x, u, p):
        return {"upper": Load(drive=u.inflow)}

    def derivative(self, x, u, p, effort):
        upper, lower = self.net_flows(x, u, p)
        return {"h_1": (upper - effort["upper"]) / p.A_1, "h_2": (lower - effort["lower"]) / p.A_2}

    def output(self, x, u, p):
        return {"upper_level": x.h_1, "lower_level": x.h_2}
