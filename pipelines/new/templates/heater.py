"""A body that a heater warms: a furnace, a motor's winding, a vessel."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

WARM = 100.0  # °C, half the range of the temperature
RATE = 0.1  # °C/s, rate of the temperature, exceeded 5 % of the time
POWER = 1000.0  # W, exceeded 5 % of the time
CAPACITY = POWER / RATE  # J/°C, the order of magnitude of C
LOSS = POWER / WARM  # W/°C, the order of magnitude of h
AMBIENT = 20.0  # °C, around the body; set it


class Heater(Plant):
    """``C T' = power - h (T - T_0) - F``: whatever else carries heat away is F."""

    name = "heater"
    meaning = "a body that a heater warms"
    source = "template heater of hybridid"
    states = (State("T", "°C", scale=WARM, observed_by="temperature", derivative=0, meaning="temperature"),)
    inputs = (Signal("power", "W", "power of the heater"),)
    outputs = (Signal("temperature", "°C", "temperature"),)
    parameters = (
        Parameter(
            "C", "J/°C", guess=CAPACITY, lower=CAPACITY / 100, upper=100 * CAPACITY, meaning="heat capacity"
        ),
        Parameter(
            "h", "W/°C", guess=LOSS, lower=LOSS / 100, upper=100 * LOSS, meaning="loss to the surroundings"
        ),
        Parameter("T_0", "°C", guess=AMBIENT, fixed=True, meaning="temperature of the surroundings"),
    )
    ports = (
        Port(
            "body",
            "flow",
            effort_unit="W",
            effort_scale=POWER,
            position_unit="°C",
            position_scale=WARM,
            velocity_scale=RATE,
            meaning="what else carries heat away",
            drive="power of the heater",
        ),
        Port("power", "input", effort_unit="W", effort_scale=POWER, meaning="heater"),
        Port("temperature", "output", effort_unit="°C", effort_scale=WARM, meaning="thermometer"),
    )

    def net_flow(self, x, u, p):
        """What the heater brings less what the surroundings take."""
        return u.power - p.h * (x.T - p.T_0)

    def motion(self, x, u, p):
        # effects at the body see how much warmer it is than the surroundings
        return {"body": Motion(position=x.T - p.T_0, velocity=self.net_flow(x, u, p) / p.C)}

    def loads(self, x, u, p):
        return {"body": Load(drive=u.power)}

    def derivative(self, x, u, p, effort):
        return {"T": (self.net_flow(x, u, p) - effort["body"]) / p.C}

    def output(self, x, u, p):
        return {"temperature": x.T}
