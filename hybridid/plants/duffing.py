"""An oscillator driven by a voltage: the model of the electronic "Silverbox"."""

from __future__ import annotations

from typing import final

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Motion, Plant


@final
class Duffing(Plant):
    """``m y'' + d y' + k y = V1 - F``: mass, damper and spring in volts, resisted at ``oscillator``.

        V2 = y + V2_0

    All signals are in volts, so m is in s², d in s, and k is dimensionless; 1/k is the static gain and
    sqrt(k/m) the resonance in rad/s. With a hardening spring, F = k_3 y³, it is a Duffing oscillator; that
    spring is an effect at the port. V2_0 is the offset of the recorded output. An offset of the input is the
    effect ``offset``.

    Source: Wigren, Schoukens (2013), "Three free data sets for development and benchmarking in
    nonlinear system identification", European Control Conference.
    """

    name = "duffing"
    meaning = "oscillator with mass, damper and spring, in volts"
    source = "Wigren, Schoukens (2013), European Control Conference"
    states = (
        State("y", "V", scale=0.05, observed_by="V2", derivative=0, meaning="displacement"),
        State("y_dot", "V/s", scale=20.0, observed_by="V2", derivative=1, meaning="velocity"),
    )
    inputs = (Signal("V1", "V", "driving force"),)
    outputs = (Signal("V2", "V", "displacement"),)
    parameters = (
        Parameter("m", "s²", guess=3e-6, lower=1e-8, upper=1e-3, meaning="mass"),
        Parameter("d", "s", guess=1e-4, lower=0.0, upper=1e-1, meaning="damping"),
        Parameter("k", "1", guess=0.5, lower=1e-3, upper=1e3, meaning="stiffness"),
        Parameter("V2_0", "V", guess=0.0, lower=-0.1, upper=0.1, scale=1e-3, meaning="offset of the output"),
    )
    ports = (
        Port(
            "oscillator",
            "effort",
            effort_unit="V",
            effort_scale=0.02,
            position_unit="V",
            position_scale=0.05,
            velocity_scale=20.0,
            epsilon=0.05,
            meaning="what resists the displacement",
            no_load="an electronic circuit: nothing slides",
        ),
        Port("V1", "input", effort_unit="V", effort_scale=0.02, meaning="generator to oscillator"),
        Port("V2", "output", effort_unit="V", effort_scale=0.05, meaning="measuring amplifier"),
    )

    def motion(self, x, u, p):
        return {"oscillator": Motion(position=x.y, velocity=x.y_dot)}

    def derivative(self, x, u, p, effort):
        force = u.V1 - effort["oscillator"]
        return {"y": x.y_dot, "y_dot": (force - p.d * x.y_dot - p.k * x.y) / p.m}

    def output(self, x, u, p):
        return {"V2": x.y + p.V2_0}
