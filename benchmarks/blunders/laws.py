"""Laws that a bench's model lacks, of a size drawn at random. Simulated."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from hybridid.declarations import Port
from hybridid.model import Model
from hybridid.rigs.truth import PlantedAt, at

Generator = np.random.Generator
LEAST, MOST = 0.2, 2.0
"""Bounds of a law's effort at the scales of its port, over the port's effort scale; log-uniform between."""


def _numbers(port: Port) -> Mapping[str, Callable[[Generator, float], Mapping[str, float]]]:
    """What the parameters of each law are for an effort of ``a`` at the scales of ``port``."""
    q, v = port.position_scale, port.velocity_scale
    return {
        "coulomb": lambda g, a: {"f_c": a},
        "stiffness": lambda g, a: {"k": a / q, "q_0": 0.0},
        "asymmetric_viscous": lambda g, a: {"difference": a / v},
        "stribeck": lambda g, a: {"amplitude": a, "velocity": v * g.uniform(0.05, 0.3)},
        "quadratic_drag": lambda g, a: {"c": a / v**2},
        "cubic_stiffness": lambda g, a: {"k_3": a / q**3, "q_0": 0.0},
        "cogging": lambda g, a: {
            "amplitude": a,
            "pitch": q * g.uniform(0.2, 2.0),
            "phase": g.uniform(0.0, 6.28),
        },
        "dahl": lambda g, a: {"amplitude": a, "stiffness": a / (q * g.uniform(0.01, 0.1))},
        "maxwell": lambda g, a: {"k": a / q, "tau": q / v * g.uniform(0.1, 1.0)},
    }


def lacking(model: Model, ports: tuple[str, ...], generator: Generator) -> PlantedAt:
    """A law that ``model`` does not contain, at one of ``ports``."""
    port = model.plant.port(str(generator.choice(ports)))
    held = {term.effect.id for term in model.terms if term.port == port.name}
    numbers = {name: make for name, make in _numbers(port).items() if name not in held}
    name = str(generator.choice(sorted(numbers)))
    effort = port.effort_scale * float(np.exp(generator.uniform(np.log(LEAST), np.log(MOST))))
    return at(port.name, name, **numbers[name](generator, effort))
