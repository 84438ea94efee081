"""Friction whose level follows what the contact carries, or what presses it: screws, gears, brakes.

The port says what it carries (``hybridid.plants.plant.Load``): ``drive`` and ``load`` are the efforts of the
two sides on the contact, both positive in the direction of motion. ``|drive - load|`` is what they press
against each other. The inertia behind the contact is not in it.
"""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, ONE, VELOCITY
from hybridid.effects.effect import Effect, EffectParameter, Local

_DUCLUSAUD = (
    "Duclusaud, Passault, Padois, Ly (2025), Extended friction models for the physics simulation of servo "
    "actuators, IEEE ICRA, arXiv:2410.08650"
)
_SCREW = "ball screw: Olaru, Puiu, Balan, Puiu (2004), in Product Engineering, Springer"
_ROUNDED = "|x| ≈ x tanh(x/w), w a hundredth of the port's effort scale"


def _loss(name: str, meaning: str) -> EffectParameter:
    return EffectParameter(name, ONE, meaning, guess=0.03, lower=0.0, upper=1.0, nests=True)


LOAD_FRICTION = Effect(
    id="load_friction",
    kind="effort",
    title="friction that grows with the load",
    equation=f"F = μ |drive - load| sign(v),  {_ROUNDED}",
    law=lambda at: at.p.mu * at.carried * at.sign,
    parameters=(_loss("mu", "share μ of the carried effort that is lost"),),
    source=(
        f"{_DUCLUSAUD}, model M3; {_SCREW}; Coulomb's law: Armstrong-Hélouvry (1991), Control of Machines "
        "with Friction, Kluwer, ch. 2"
    ),
    pattern=(
        "Coulomb friction whose level follows the effort through the contact: more at acceleration than "
        "at cruise. While the drive accelerates, the input seems too weak by the share μ; while it "
        "brakes, too strong"
    ),
    look_alikes=("input_saturation", "input_gain", "coulomb", "quadratic_drag", "back_emf_limit"),
    separating_experiment=(
        "the same slow constant-velocity runs with a weight or a spring that the drive must hold, in several"
        " sizes: half the difference between the directions grows with the weight. A saturation or a gain "
        "shows in their mean, and does not brake when the input does"
    ),
    needs=("load",),
)

LOAD_STRIBECK = Effect(
    id="load_stribeck",
    kind="effort",
    title="Stribeck friction that grows with the load",
    equation=f"F = μ_s |drive - load| exp(-(v/v_s)²) sign(v),  {_ROUNDED}",
    law=lambda at: at.p.mu_s * at.carried * ca.exp(-((at.velocity / at.p.v_s) ** 2)) * at.sign,
    parameters=(
        _loss("mu_s", "share μ_s of the carried effort that is lost at break-away, above μ"),
        EffectParameter(
            "v_s", VELOCITY, "Stribeck velocity", guess=0.1, lower=0.01, upper=2.0, starts=(0.03, 0.3)
        ),
    ),
    source=f"{_DUCLUSAUD}, model M4",
    pattern=(
        "friction falls with speed just after break-away, and the more so the larger the load is there. "
        "Below v_s and at one size of the load it is Coulomb friction"
    ),
    look_alikes=("stribeck", "load_friction", "coulomb", "lugre", "input_dead_zone"),
    separating_experiment=(
        "constant-velocity runs at ten speeds, logarithmically spaced, with and without a weight to hold: "
        "the falling branch grows with the weight"
    ),
    needs=("load",),
)


def _two_sided(at: Local) -> ca.SX:
    return (at.p.mu_d * at.driven + at.p.mu_l * at.loaded) * at.sign


TWO_SIDED_LOAD_FRICTION = Effect(
    id="two_sided_load_friction",
    kind="effort",
    title="load friction that differs between driving and being driven",
    equation=f"F = (μ_d |drive| + μ_l |load|) sign(v),  {_ROUNDED}",
    law=_two_sided,
    parameters=(
        _loss("mu_d", "share μ_d of the drive's effort that is lost"),
        _loss("mu_l", "share μ_l of the load's effort that is lost"),
    ),
    source=(
        f"{_DUCLUSAUD}, model M5, whose |μ_d drive - μ_l load| this is wherever the two sides oppose each "
        "other; efficiency of driving and of being driven: Shigley's Mechanical Engineering Design, 10th "
        "ed. (2015), sec. 8-2 (power screws)"
    ),
    pattern=(
        "a gear or screw that loses more when its load drives it than when it drives the load (or less); "
        "with μ_d = μ_l it is load_friction"
    ),
    look_alikes=("load_friction", "input_gain", "asymmetric_coulomb", "input_saturation"),
    separating_experiment=(
        "lift and lower several weights slowly at one speed: the loss over the weight differs between "
        "lifting and lowering"
    ),
    needs=("both_sides",),
)

INPUT_SCALED_FRICTION = Effect(
    id="input_scaled_friction",
    kind="effort",
    title="friction whose level an input sets",
    equation="F = f_u level sign(v)",
    law=lambda at: at.p.f_u * at.level * at.sign,
    parameters=(
        EffectParameter(
            "f_u", EFFORT, "Coulomb level where the level is 1", guess=0.3, lower=0.0, nests=True
        ),
    ),
    source=(
        "Spencer, Dyke, Sain, Carlson (1997), Phenomenological model for magnetorheological dampers, ASCE "
        "J. Engineering Mechanics 123(3), 230-238 (yield force linear in the voltage)"
    ),
    pattern=(
        "a step where the velocity changes sign, whose height follows a field, a pressure or a temperature "
        "and not the motion"
    ),
    look_alikes=("coulomb", "friction_drift", "warming_friction", "load_friction"),
    separating_experiment=(
        "the same slow strokes at three constant levels: the step's height is a straight line over the "
        "level, and what is left at level zero is Coulomb friction"
    ),
    needs=("level",),
)
