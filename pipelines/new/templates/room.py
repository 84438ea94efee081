"""A body that a heater warms, in surroundings of a measured temperature: a room, an oven, a vessel."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant

WARM = 5.0  # °C, half the range of the temperature
EXCESS = 20.0  # °C, temperature above the surroundings, exceeded 5 % of the time
OUTSIDE = 10.0  # °C, of the surroundings, exceeded 5 % of the time
RATE = 1e-3  # °C/s, rate of the temperature, exceeded 5 % of the time
POWER = 1000.0  # W, exceeded 5 % of the time
CAPACITY = POWER / RATE  # J/°C, the order of magnitude of C
LOSS = POWER / EXCESS  # W/°C, the order of magnitude of h


class Room(Plant):
    """``C T' = power - h (T - surroundings) - F``: whatever else carries heat away is F."""

    name = "room"
    meaning = "a body that a heater warms, in surroundings of a measured temperature"
    source = "template room of hybridid"
    states = (State("T", "°C", scale=WARM, observed_by="temperature", derivative=0, meaning="temperature"),)
    inputs = (
        Signal("power", "W", "power of the heater"),
        Signal("surroundings", "°C", "temperature of the surroundings"),
    )
    outputs = (Signal("temperature", "°C", "temperature"),)
    parameters = (
        Parameter(
            "C", "J/°C", guess=CAPACITY, lower=CAPACITY / 100, upper=100 * CAPACITY, meaning="heat capacity"
        ),
        Parameter(
            "h", "W/°C", guess=LOSS, lower=LOSS / 100, upper=100 * LOSS, meaning="loss to the surroundings"
        ),
    )
    ports = (
        Port(
            "body",
            "flow",
            effort_unit="W",
            effort_scale=POWER,
            position_unit="°C",
            position_scale=EXCESS,
            velocity_scale=RATE,
            meaning="what else carries heat away",
            drive="power of the heater",
        ),
        Port("power", "input", effort_unit="W", effort_scale=POWER, meaning="heater"),
        Port(
            "surroundings",
            "input",
            effort_unit="°C",
            effort_scale=OUTSIDE,
            meaning="thermometer in the surroundings",
        ),
        Port("temperature", "output", effort_unit="°C", effort_scale=WARM, meaning="thermometer"),
    )

    def net_flow(self, x, u, p):
        """What the heater brings less what the surroundings take."""
        return u.power - p.h * (x.T - u.surroundings)

    def motion(self, x, u, p):
        # effects at the body see how much warmer it is than the surroundings, and the rate of its own
        # temperature: what stores its heat follows that
        return {"body": Motion(position=x.T - u.surroundings, velocity=self.net_flow(x, u, p) / p.C)}

    def loads(self, x, u, p):
        return {"body": Load(drive=u.power)}

    def derivative(self, x, u, p, effort):
        return {"T": (self.net_flow(x, u, p) - effort["body"]) / p.C}

    def output(self, x, u, p):
        return {"temperature": x.T}
