"""A drive whose strength depends on position: voice coils off their centre, motors with torque ripple.

The effort that passes is ``drive (1 - share(q))``. The constant part of the share is the gain of the input,
which scales all other parameters of most plants, so no effect here has it.
"""

from __future__ import annotations

import math

import casadi as ca

from hybridid.effects.dimension import ONE, Dimension
from hybridid.effects.disturbance import PITCH
from hybridid.effects.effect import Effect, EffectParameter

LOSS_SLOPE, LOSS_CURVATURE = Dimension(position=-1), Dimension(position=-2)

VARYING_FORCE_FACTOR = Effect(
    id="varying_force_factor",
    kind="effort",
    title="drive that loses strength off its centre",
    equation="F = drive (b_1 q + b_2 q²)",
    law=lambda at: at.drive * (at.p.b_1 + at.p.b_2 * at.position) * at.position,
    parameters=(
        EffectParameter("b_1", LOSS_SLOPE, "share of the drive that is lost with q", guess=0.03, nests=True),
        EffectParameter(
            "b_2", LOSS_CURVATURE, "share of the drive that is lost with q²", guess=0.03, nests=True
        ),
    ),
    source=(
        "Klippel (2006), Loudspeaker nonlinearities - causes, parameters, symptoms, J. Audio Eng. Soc. "
        "54(10), 907-939: the force factor Bl(x), to second order"
    ),
    pattern=(
        "the same current pushes less at one place of the stroke than at another; without a current nothing "
        "is missing. It follows the product of drive and position, a spring the position alone"
    ),
    look_alikes=("torque_ripple", "input_gain", "input_saturation", "cubic_stiffness", "sensor_nonlinearity"),
    separating_experiment=(
        "hold the machine at five places of the stroke, and add the same small drive at each: what it "
        "accelerates, or the force on a load cell, is a curve over position. A spring or a detent shows "
        "without the drive, too"
    ),
    needs=("drive",),
)


def _ripple(name: str, of: str) -> EffectParameter:
    return EffectParameter(name, ONE, f"share of the drive, {of}", guess=0.03, nests=True)


TORQUE_RIPPLE = Effect(
    id="torque_ripple",
    kind="effort",
    title="ripple of the motor constant",
    equation="F = drive (b_s sin(2π q/pitch) + b_c cos(2π q/pitch))",
    law=lambda at: (
        at.drive
        * (
            at.p.b_s * ca.sin(2 * math.pi * at.position / at.p.pitch)
            + at.p.b_c * ca.cos(2 * math.pi * at.position / at.p.pitch)
        )
    ),
    parameters=(
        _ripple("b_s", "amplitude of the sine"),
        _ripple("b_c", "amplitude of the cosine"),
        PITCH,
    ),
    source=(
        "Jahns, Soong (1996), Pulsating torque minimization techniques for permanent magnet AC motor drives "
        "- a review, IEEE Trans. Industrial Electronics 43(2), 321-330"
    ),
    pattern=(
        "periodic in position, in proportion to the drive, and of the drive's sign; cogging is the same with "
        "the current off"
    ),
    look_alikes=("cogging", "varying_force_factor", "position_friction", "sensor_periodic_error"),
    separating_experiment=(
        "constant-velocity runs with two loads over many pitches: this ripple grows with the load, cogging "
        "does not"
    ),
    needs=("drive",),
)
