"""A tank with a pump and an outlet."""

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

LEVEL = 0.3  # m, exceeded 5 % of the time
RATE = 0.01  # m/s, rate of the level, exceeded 5 % of the time
FLOW = 1e-4  # m³/s, exceeded 5 % of the time
SECTION = FLOW / RATE  # m², the order of magnitude of A
OUTLET = FLOW / LEVEL**0.5  # m^2.5/s, the order of magnitude of c


class Tank(Plant):
    """``A h' = inflow - c √h - F``: whatever else leaves the tank is F."""

    name = "tank"
    meaning = "a tank with a pump and an outlet"
    source = "template tank of hybridid"
    states = (State("h", "m", scale=LEVEL, observed_by="level", derivative=0, meaning="level"),)
    inputs = (Signal("inflow", "m³/s", "flow of the pump"),)
    outputs = (Signal("level", "m", "level over the outlet"),)
    parameters = (
        Parameter("A", "m²", guess=SECTION, lower=SECTION / 100, upper=100 * SECTION, meaning="section"),
        Parameter("c", "m^2.5/s", guess=OUTLET, lower=OUTLET / 100, upper=100 * OUTLET, meaning="outlet"),
    )
    ports = (
        Port(
            "tank",
            "flow",
            effort_unit="m³/s",
            effort_scale=FLOW,
            position_unit="m",
            position_scale=LEVEL,
            velocity_scale=RATE,
            meaning="what else leaves",
            drive="flow of the pump",
        ),
        Port("inflow", "input", effort_unit="m³/s", effort_scale=FLOW, meaning="pump"),
        Port("level", "output", effort_unit="m", effort_scale=LEVEL, meaning="gauge"),
    )

    def net_flow(self, x, u, p):
        """What the pump brings less what the outlet takes."""
        return u.inflow - p.c * ca.sqrt(ca.fmax(x.h, 1e-6 * LEVEL))

    def motion(self, x, u, p):
        return {"tank": Motion(position=x.h, velocity=self.net_flow(x, u, p) / p.A)}

    def loads(self, x, u, p):
        return {"tank": Load(drive=u.inflow)}

    def derivative(self, x, u, p, effort):
        return {"h": (self.net_flow(x, u, p) - effort["tank"]) / p.A}

    def output(self, x, u, p):
        return {"level": x.h}
