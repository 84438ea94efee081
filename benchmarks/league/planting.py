"""``Hidden``: one effect at work in a rig that nobody declared, and what the library calls its values."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from benchmarks.league.laws import OUTSIDE, OWN_LAWS
from hybridid.effects.effect import Effect
from hybridid.effects.library import effect_named
from hybridid.rigs.law_library import law_named
from hybridid.rigs.laws import Law, Planted
from hybridid.rigs.truth import PlantedAt

Values = Mapping[str, float]
PATHS = ("input_gain", "input_delay", "input_lag", "input_saturation", "input_dead_zone", "sensor_lag")
"""Effects of a drive or a sensor: a rig has them as its own, without a law."""

# from a law's values to those of the library's effect; by default they have the same names
TRANSLATED: Mapping[str, Callable[[Values], dict[str, float]]] = {
    "asymmetric_viscous": lambda v: {"df_v": v["difference"]},
    "asymmetric_coulomb": lambda v: {"df_c": v["difference"]},
    "stribeck": lambda v: {"df_s": v["amplitude"], "v_s": v["velocity"]},
    "quadratic_drag": lambda v: {"c_d": v["c"]},
    "linear_stiffness": lambda v: {"k": v["k"]},
    "cogging": lambda v: {
        "A_s": v["amplitude"] * math.cos(v["phase"]),
        "A_c": v["amplitude"] * math.sin(v["phase"]),
        "pitch": v["pitch"],
    },
    "position_friction": lambda v: {"slope": v["slope"]},
    "friction_drift": lambda v: {"r_c": v["rate"]},
    "dahl": lambda v: {"f_c": v["amplitude"], "s": v["amplitude"] / v["stiffness"]},
    "lugre": lambda v: {
        "f_c": v["f_c"],
        "s": v["f_c"] / v["sigma_0"],
        "tau_b": v["sigma_1"] / v["sigma_0"],
        "r_s": v["f_s"] / v["f_c"] - 1,
        "v_s": v["v_s"],
    },
    "flexible_mode": lambda v: {"m_l": v["mass"], "frequency": v["frequency"], "zeta": v["damping"]},
    "backlash": lambda v: {
        "m_l": v["mass"], "frequency": v["frequency"], "zeta": v["damping"], "g": v["gap"]
    },
    "asymmetric_damper": lambda v: {"dc": v["difference"], "v_k": v["knee"]},
    "input_gain": lambda v: {"g": v["gain"] - 1},
    "input_delay": lambda v: {"delay": v["delay"]},
    "input_lag": lambda v: {"T": v["lag"]},
    "sensor_lag": lambda v: {"T": v["lag"]},
    "input_saturation": lambda v: {"inverse_limit": 1 / v["limit"]},
    "input_dead_zone": lambda v: {"d": v["dead_zone"]},
}  # fmt: skip
LAW_OF = {"linear_stiffness": "stiffness"}


@dataclass(frozen=True)
class Hidden:
    """The effect ``what`` at ``port``; ``values`` are of the rig's law, drive or sensor, in SI units."""

    what: str
    port: str
    values: Values = field(default_factory=dict)

    @property
    def name(self) -> str:
        """As the trace names a term: ``port.effect``."""
        return f"{self.port}.{self.what}"

    @property
    def on_path(self) -> bool:
        return self.what in PATHS

    @property
    def law(self) -> Law:
        return OWN_LAWS[self.what] if self.what in OWN_LAWS else law_named(LAW_OF.get(self.what, self.what))

    @property
    def planted(self) -> PlantedAt:
        return PlantedAt(self.port, Planted(self.law, tuple(self.values.items())))

    @property
    def effect(self) -> Effect:
        """What the oracle adds to the declared model: the library's, or the twin of a law outside it."""
        # the library may know a law of the league by now, under the same name, with its own parameters
        return OUTSIDE[self.what] if self.what in OUTSIDE else effect_named(self.what)

    @property
    def truth(self) -> dict[str, float]:
        """The effect's parameters as planted, in its own terms."""
        return TRANSLATED.get(self.what, dict)(self.values)
