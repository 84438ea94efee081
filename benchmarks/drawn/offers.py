"""What may be hidden where: effects of the library, named laws outside it, and factors of composed laws.

Each law has one place in its list and is drawn with equal chance; ``COMPOSED`` stands for all composed laws
and has as many places as named laws, so that half of what is outside the library is composed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

Offers = tuple[tuple[str, tuple[str, ...]], ...]
COMPOSED = "composed"
LATE = {"input_delay": "delay", "input_lag": "lag", "sensor_lag": "lag"}
"""Effects whose amount is a time, no effort, and what the rig calls it."""


def _at(port: str, *effects: str) -> Offers:
    return tuple((effect, (port,)) for effect in effects)


def _and_composed(named: Offers, *ports: str) -> Offers:
    """As many composed laws as named ones, at each of ``ports`` in turn."""
    return (*named, *((COMPOSED, (ports[k % len(ports)],)) for k in range(len(named))))


FRONT, REAR = "front_suspension", "rear_suspension"
CARRIAGE = (
    *_at(
        "carriage", "asymmetric_viscous", "stribeck", "quadratic_drag", "linear_stiffness", "cubic_stiffness",
        "cogging", "position_friction", "friction_drift", "end_stop", "dahl", "lugre", "bouc_wen", "maxwell",
        "flexible_mode", "backlash",
    ),
    *_at("force", "input_dead_zone", "input_saturation", "input_delay", "input_lag"),
    *_at("position", "sensor_lag"),
)  # fmt: skip
LIBRARY: Mapping[str, Offers] = {
    "carriage": CARRIAGE,
    "carriage_open": CARRIAGE,
    "oscillator": (
        *_at(
            "oscillator", "cubic_stiffness", "quadratic_drag", "coulomb", "asymmetric_viscous", "dahl",
            "bouc_wen", "maxwell", "end_stop",
        ),
        *_at("V1", "input_saturation", "input_dead_zone", "input_delay"),
    ),
    "flexible_link": (
        *_at(
            "servo", "coulomb", "stribeck", "quadratic_drag", "linear_stiffness", "cogging",
            "asymmetric_viscous", "dahl",
        ),
        *_at("link", "cubic_stiffness", "coulomb", "quadratic_drag", "maxwell"),
        *_at("voltage", "input_saturation", "input_dead_zone"),
    ),
    "esea": (
        *_at("motor", "coulomb", "cogging", "quadratic_drag"),
        *_at("elastomer", "cubic_stiffness", "viscous", "maxwell"),
        *_at("link", "coulomb", "quadratic_drag"),
        *_at("torque", "input_gain", "input_saturation"),
    ),
    "half_car": (
        *_at(FRONT, "asymmetric_damper", "cubic_stiffness", "coulomb", "quadratic_drag"),
        *_at(REAR, "asymmetric_damper", "cubic_stiffness", "coulomb", "quadratic_drag"),
    ),
}  # fmt: skip
LOADED = ("load_friction", "two_sided_load_friction", "following_friction")
OF_A_CARRIAGE = (
    *LOADED, "varying_inertia", "friction_behind_gap", "hardening_hysteresis", "eddy_brake", "heating",
    "dent", "position_damping", "blow_off",
)  # fmt: skip
OUTSIDE: Mapping[str, Offers] = {
    "carriage": _and_composed(_at("carriage", *OF_A_CARRIAGE), "carriage"),
    "carriage_open": _and_composed(_at("carriage", *OF_A_CARRIAGE[:-2], "blow_off"), "carriage"),
    "oscillator": _and_composed(
        _at("oscillator", *LOADED, "varying_inertia", "friction_behind_gap", "hardening_hysteresis"),
        "oscillator",
    ),
    "flexible_link": _and_composed(
        (
            *_at("servo", *LOADED, "friction_behind_gap", "eddy_brake", "dent"),
            *_at("link", "hardening_hysteresis", "friction_behind_gap"),
        ),
        "servo",
        "servo",
        "link",
    ),
    "esea": _and_composed(
        (*_at("motor", *LOADED, "dent", "eddy_brake"), *_at("elastomer", "hardening_hysteresis")),
        "motor",
        "link",
    ),
    "half_car": _and_composed(
        (
            *(3 * (("asymmetric_damper", (FRONT, REAR)),)),
            *(3 * (("cubic_stiffness", (FRONT, REAR)),)),
            *_at(FRONT, "blow_off"),
            *_at(REAR, "blow_off"),
        ),
        FRONT,
        REAR,
    ),
}  # fmt: skip
CARRIERS = (
    "direction.velocity", "stribeck.velocity", "linear.velocity", "signed_square.velocity", "peak.velocity",
    "saturating.velocity", "bump.position", "signed_square.position", "sine.position", "linear.load",
    "linear.acceleration",
)  # fmt: skip
"""What gives the effort its direction."""
MODULATORS = (
    "modulus.position", "square.position", "bump.position", "step.position", "one_sided.position",
    "modulus.load", "square.load", "one_sided.load", "modulus.acceleration", "square.acceleration",
    "step.time", "decay.time", "linear.time", "linear.travel", "growth.travel", "decay.travel",
    "bump.velocity", "modulus.velocity",
)  # fmt: skip
"""What sets its level: nowhere negative."""
BOUNDED = (
    "bump.position", "step.position", "step.time", "decay.time", "growth.travel", "decay.travel"
)  # fmt: skip
"""Modulators of a drive's effort: they never exceed one."""
EITHER_WAY = ("bump.position", "sine.position", "linear.load")
"""Carriers that may push as well as resist; the others would make a machine run away."""
HELD = {"direction.velocity*linear.time"}
"""Products that the library holds (``friction_drift``)."""
STATIC = ("position", "velocity", "time")
"""Variables at the half-car, whose rig has no drive."""


def composed_factors(generator: np.random.Generator, machine: str) -> tuple[str, str]:
    """A carrier and a modulator over different variables, drawn with equal chance."""
    carriers, modulators = (_possible(part, machine) for part in (CARRIERS, MODULATORS))
    pairs = [
        (f, g)
        for f in carriers
        for g in modulators
        if _variable(f) != _variable(g)
        and f"{f}*{g}" not in HELD
        and (_variable(f) != "load" or g in BOUNDED)
    ]
    return pairs[generator.integers(len(pairs))]


def _possible(factors: Sequence[str], machine: str) -> list[str]:
    if machine != "half_car":
        return list(factors)
    return [one for one in factors if _variable(one) in STATIC]


def _variable(factor: str) -> str:
    return factor.rpartition(".")[2]
