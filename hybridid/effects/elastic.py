"""Springs and other efforts that depend on position, with or without relaxation."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from hybridid.effects.dimension import EFFORT, POSITION, STIFFNESS, TIME, Dimension
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local
from hybridid.effects.smooth import saturated

CUBIC = Dimension(effort=1, position=-3)

LINEAR_STIFFNESS = Effect(
    id="linear_stiffness",
    kind="effort",
    title="linear spring",
    equation="F = k q",
    law=lambda at: at.p.k * at.position,
    parameters=(EffectParameter("k", STIFFNESS, "stiffness; negative softens another spring", nests=True),),
    source="Den Hartog (1956), Mechanical Vibrations, 4th ed., ch. 2",
    pattern="proportional to position, the same on the way out and back; zero where the position is zero",
    look_alikes=(
        "preloaded_spring",
        "offset",
        "cubic_stiffness",
        "maxwell",
        "position_friction",
        "gravity",
        "free_play",
        "detent",
    ),
    separating_experiment=(
        "slow runs over the whole stroke in both directions, and long holds at its ends: the mean of the "
        "two directions is a straight line that does not relax"
    ),
)

PRELOADED_SPRING = Effect(
    id="preloaded_spring",
    kind="effort",
    title="linear spring with preload",
    equation="F = F_0 + k q: a linear spring about -F_0/k",
    law=lambda at: at.p.F_0 + at.p.k * at.position,
    parameters=(
        EffectParameter("k", STIFFNESS, "stiffness; negative softens another spring", nests=True),
        EffectParameter("F_0", EFFORT, "preload: the effort at q = 0", guess=0.0, nests=True),
    ),
    source="Wahl (1963), Mechanical Springs, 2nd ed., McGraw-Hill (initial tension)",
    pattern=(
        "a straight line over position that does not pass through zero, the same on the way out and back: "
        "the spring is at rest elsewhere than where the sensor shows zero"
    ),
    look_alikes=("linear_stiffness", "offset", "cubic_stiffness", "gravity", "detent", "end_stop", "maxwell"),
    separating_experiment=(
        "slow runs over the whole stroke in both directions: the mean of the two directions is a straight "
        "line, whose zero is where the spring is at rest"
    ),
    sum_of=("linear_stiffness", "offset"),
)

CUBIC_STIFFNESS = Effect(
    id="cubic_stiffness",
    kind="effort",
    title="cubic spring",
    equation="F = k_3 (q - q_0)³",
    law=lambda at: at.p.k_3 * (at.position - at.p.q_0) ** 3,
    parameters=(
        EffectParameter("k_3", CUBIC, "cubic stiffness: hardening above, softening below zero", nests=True),
        EffectParameter(
            "q_0", POSITION, "centre of the spring", guess=0.0, lower=-3.0, upper=3.0, sought="place"
        ),
    ),
    source=(
        "Nayfeh, Mook (1979), Nonlinear Oscillations, Wiley, ch. 4; Duffing (1918), Erzwungene Schwingungen"
    ),
    pattern=(
        "a resonance that moves with amplitude, and third harmonics; the spring is straight at small "
        "amplitudes"
    ),
    look_alikes=(
        "linear_stiffness",
        "free_play",
        "end_stop",
        "bouc_wen",
        "hardening_hysteresis",
        "gravity",
        "detent",
        "sensor_nonlinearity",
    ),
    separating_experiment=(
        "slow sweeps through resonance, or slow strokes, at amplitudes from a tenth to the largest "
        "allowed: the shift of the resonance grows with the square of the amplitude and the loop encloses"
        " no area"
    ),
)

FREE_PLAY = Effect(
    id="free_play",
    kind="effort",
    title="free play in a spring",
    equation="F = -k sat(q, g),  so that a spring k becomes k (q - sat(q, g)): slack within ±g",
    law=lambda at: -at.p.k * saturated(at.position, at.p.g, at.p.width),
    parameters=(
        EffectParameter(
            "k", STIFFNESS, "stiffness that is missing in the gap", guess=0.3, lower=0.0, nests=True
        ),
        EffectParameter("g", POSITION, "half the gap", guess=0.1, lower=1e-3, upper=3.0, starts=(0.01, 0.5)),
        EffectParameter("width", POSITION, "rounding of the gap's edges", guess=1e-4, lower=0.0, fixed=True),
    ),
    source=(
        "Nordin, Gutman (2002), Controlling mechanical systems with backlash: a survey, Automatica "
        "38(10), 1633-1649, dead-zone model; Conner, Tang, Dowell, Virgin (1997), J. Fluids and "
        "Structures 11(1), 89-109"
    ),
    pattern=(
        "a joint whose own spring goes slack near zero deflection: soft at small, stiff at large "
        "amplitudes. At a port that measures the deflection between two bodies; a body behind a play is "
        "backlash"
    ),
    look_alikes=("cubic_stiffness", "backlash", "linear_stiffness", "dahl"),
    separating_experiment=(
        "hold one side and push the other slowly through zero, with amplitudes below and above the gap: "
        "without effort inside it, a straight spring outside it, no loop"
    ),
)

MAXWELL = Effect(
    id="maxwell",
    kind="effort",
    title="viscoelastic branch (Maxwell element)",
    equation="F = k x,  x' = v - x/τ  (spring k and damper k τ in series)",
    law=lambda at: at.p.k * at.z.x,
    dynamics=lambda at: {"x": at.velocity - at.z.x / at.p.tau},
    parameters=(
        EffectParameter(
            "k", STIFFNESS, "stiffness of the branch at fast motion", guess=0.3, lower=0.0, nests=True
        ),
        EffectParameter(
            "tau", TIME, "relaxation time τ", guess=0.1, lower=0.001, upper=1000.0, starts=(0.02, 1.0)
        ),
    ),
    states=(EffectState("x", POSITION, "deflection of the branch's spring"),),
    source="Findley, Lai, Onaran (1976), Creep and Relaxation of Nonlinear Viscoelastic Materials, ch. 5",
    pattern=(
        "between a damper (slow motion) and a spring (fast motion): effort that relaxes when the motion "
        "stops, a loop whose width depends on frequency and scales with amplitude"
    ),
    look_alikes=("viscous", "linear_stiffness", "bouc_wen", "dahl", "flexible_mode", "hardening_hysteresis"),
    separating_experiment=(
        "a step of position held for ten times τ, and small sines over two decades of frequency about "
        "1/τ: relaxation, and loss and stiffness that change with frequency but not with amplitude"
    ),
)


def _further_branch(nth: str, beside: str) -> Effect:
    """One more Maxwell element in parallel: a sum of exponentials (a Prony series) is how relaxation that is
    spread over decades is described."""
    stiffness, time = MAXWELL.parameters
    return replace(
        MAXWELL,
        id=f"{nth}_maxwell",
        title=f"{nth} viscoelastic branch (generalized Maxwell model)",
        equation=f"F = k x,  x' = v - x/τ, beside {beside}",
        parameters=(
            replace(stiffness, guess=0.1),
            replace(time, guess=1.0, starts=(0.01, 0.1, 10.0)),
        ),
        pattern=(
            "relaxation that is fast first and slow later: it is spread over more than a decade of time or "
            "frequency, as in rubber; one Maxwell element relaxes by one exponential"
        ),
        look_alikes=(beside, "viscous", "linear_stiffness", "flexible_mode", "dahl", "bouc_wen"),
        separating_experiment=(
            "a step of position held for ten times the longest τ: the logarithm of the relaxing effort has "
            "one slope for each branch, whatever the amplitude"
        ),
        beside=beside,
    )


SECOND_MAXWELL = _further_branch("second", "maxwell")
THIRD_MAXWELL = _further_branch("third", "second_maxwell")

# sin and cos need an angle: only at ports in rad
GRAVITY = Effect(
    id="gravity",
    kind="effort",
    title="gravity on a turning body",
    equation="F = G_s sin(q) + G_c cos(q)",
    law=lambda at: at.p.G_s * ca.sin(at.position) + at.p.G_c * ca.cos(at.position),
    parameters=(
        EffectParameter(
            "G_s", EFFORT, "weight times lever, part that acts at q = 90°", guess=0.0, nests=True
        ),
        EffectParameter("G_c", EFFORT, "weight times lever, part that acts at q = 0", guess=0.0, nests=True),
    ),
    source=(
        "Khalil, Dombre (2002), Modeling, Identification and Control of Robots, ch. 9 (first moments times g)"
    ),
    pattern=(
        "a sine of the angle with period 2π, the same in both directions and at rest; on a sliding axis "
        "gravity is an offset"
    ),
    look_alikes=("offset", "linear_stiffness", "cogging", "cubic_stiffness", "cyclic_inertia"),
    separating_experiment=(
        "slow turns through more than half a revolution in both directions, or the same run with the axis"
        " tilted: gravity follows the tilt"
    ),
    position_units=("rad",),
)


def _catch(at: Local) -> ca.SX:
    x = (at.position - at.p.q_0) / at.p.w
    return at.p.F_d * x * ca.exp(0.5 * (1 - x**2))


DETENT = Effect(
    id="detent",
    kind="effort",
    title="detent",
    equation="F = F_d x exp((1 - x²)/2),  x = (q - q_0)/w: largest, F_d, at q_0 ± w",
    law=_catch,
    parameters=(
        EffectParameter(
            "F_d", EFFORT, "effort to leave the catch; negative: a hump in the way", guess=0.1, nests=True
        ),
        EffectParameter(
            "q_0", POSITION, "place of the catch", guess=0.0, lower=-5.0, upper=5.0, sought="place"
        ),
        EffectParameter(
            "w", POSITION, "from the place to where it holds most", guess=0.1, lower=0.01, upper=0.5
        ),
    ),
    source=(
        "a sprung ball in a notch: Maplesoft, MapleSim, component Translational Detent; detents measured: "
        "Swindells, MacLean (2006), University of British Columbia TR-2006-14. The form here is the slope of "
        "a Gaussian well, which is smooth"
    ),
    pattern=(
        "a spring about one place only: the machine is held there, drawn in from both sides, and left alone "
        "farther away; the same in both directions"
    ),
    look_alikes=("cogging", "cubic_stiffness", "linear_stiffness", "position_friction"),
    separating_experiment=(
        "slow constant-velocity runs over the whole stroke in both directions: the mean of the two shows one "
        "wave at one place, where cogging shows many"
    ),
)
