"""Gain, lag and offset of a signal between the command and the machine, or the machine and the sensor.

The pole of a lag grows without bound as its time constant T goes to zero. Here the pole has a limit: the
increment is ``(T/T_e) (z - u)`` with ``T_e z' = u - z`` and ``T_e = √(T² + floor²)``. It is smooth in T and
exactly zero at T = 0. At low frequency it is a delay of T for every T. For T well above the floor it is
the lag ``1/(1 + T s)``.

The state of a sensor's lag is how far it is behind, ``w = y - z`` with ``w' = y' - w/T_e``. Like every inner
state it is handed on from horizon to horizon. The lagged signal z itself would be estimated anew for each
horizon, as the output shows it: one more free value a horizon, which also takes what is no lag.
"""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, ONE, TIME
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local

LAG = EffectParameter(
    "T", TIME, "time constant", guess=2e-3, lower=0.0, upper=10.0, starts=(2e-2,), nests=True, absolute=True
)
FLOOR = EffectParameter(
    "floor",
    TIME,
    "fastest pole's time constant, fixed: below the sampling time",
    guess=5e-4,
    lower=1e-9,
    fixed=True,
    absolute=True,
)

SETTLED = EffectParameter(
    "settled",
    ONE,
    "1: settled at the input's first sample before each record; 0: the input was switched on with it; fixed",
    guess=1.0,
    lower=0.0,
    upper=1.0,
    fixed=True,
)


def _lag_time(at: Local) -> ca.SX:
    return ca.sqrt(at.p.T**2 + at.p.floor**2)


def _lagged(at: Local) -> ca.SX:
    return at.p.T / _lag_time(at) * (at.z.z - at.signal)


def _lag_rate(at: Local) -> dict[str, ca.SX]:
    return {"z": (at.signal - at.z.z) / _lag_time(at)}


def _behind(at: Local) -> ca.SX:
    return -at.p.T / _lag_time(at) * at.z.w


def _behind_rate(at: Local) -> dict[str, ca.SX]:
    return {"w": at.rate - at.z.w / _lag_time(at)}


def _ahead(at: Local) -> ca.SX:
    return at.p.T * at.rate


_LAG_EQUATION = "y = {0} + (T/T_e) (z - {0}),  T_e z' = {0} - z,  T_e = √(T² + floor²): 1/(1 + T s)"
_ASTROM = "Åström, Murray (2021), Feedback Systems, 2nd ed."

INPUT_GAIN = Effect(
    id="input_gain",
    kind="input",
    title="input gain that is off",
    equation="u → (1 + g) u",
    law=lambda at: at.p.g * at.signal,
    parameters=(
        EffectParameter(
            "g", ONE, "relative error of the gain", guess=0.02, lower=-0.9, upper=10.0, nests=True
        ),
    ),
    source="Ljung (1999), System Identification, 2nd ed., sec. 4.3 (gain of a process)",
    pattern=(
        "scales everything the input does; where inertia and friction are free too they take it up, so it"
        " speaks only where one of them is known or the machine has several inputs"
    ),
    look_alikes=(
        "added_inertia",
        "input_saturation",
        "sensor_scale",
        "load_friction",
        "two_sided_load_friction",
    ),
    separating_experiment=(
        "measure the effort itself, or repeat the run with a known inertia attached. Against load friction, "
        "brake hard: a gain that is too low weakens the braking, load friction adds to it"
    ),
)

INPUT_LAG = Effect(
    id="input_lag",
    kind="input",
    title="lag of the drive",
    equation=_LAG_EQUATION.format("u") + ",  z(0) = settled u(0)",
    law=_lagged,
    dynamics=_lag_rate,
    parameters=(LAG, FLOOR, SETTLED),
    states=(EffectState("z", EFFORT, "lagged input", follows=SETTLED.name),),
    source=_ASTROM + ", sec. 6.3 (first-order lag); its floor as in hybridid.effects.paths",
    pattern="late as a delay is at low frequency, but weaker too at high frequency; steps arrive rounded",
    look_alikes=("input_delay", "sensor_lag", "input_rate_limit", "stribeck", "flexible_mode"),
    separating_experiment=(
        "steps or a chirp of the command beyond 1/(2π T), with the drive's output measured: a lag rounds "
        "and attenuates, a delay only shifts"
    ),
)


SENSOR_LAG = Effect(
    id="sensor_lag",
    kind="output",
    title="lag of the sensor",
    equation="y → y - (T/T_e) w,  w' = y' - w/T_e,  T_e = √(T² + floor²): 1/(1 + T s)",
    law=_behind,
    dynamics=_behind_rate,
    parameters=(LAG, FLOOR),
    states=(EffectState("w", EFFORT, "how far the sensor is behind"),),
    needs=("rate",),
    source=_ASTROM + ", sec. 6.3 (first-order lag); its floor as in hybridid.effects.paths",
    pattern="the output is late in proportion to its rate of change, and so is a delay on the drive's side",
    look_alikes=("input_lag", "input_delay", "flexible_mode"),
    separating_experiment=(
        "a second, fast sensor for one run; failing that, a disturbance that does not come through the "
        "drive: only the sensor's lag delays its effect"
    ),
)

INPUT_RECORD_LAG = Effect(
    id="input_record_lag",
    kind="output",
    title="record of the inputs that lags behind this output",
    equation="y → y + T y': what drives the machine was recorded through a lag 1/(1 + T s)",
    law=_ahead,
    parameters=(LAG,),
    needs=("rate",),
    source=_ASTROM + ", sec. 6.3 (first-order lag, here of the instrument that recorded the input)",
    pattern=(
        "the machine answers before it is driven: a fault of the recording, not of the machine (an "
        "anti-alias filter in one channel, a force sensor's amplifier, clocks that differ)"
    ),
    look_alikes=("sensor_lag", "input_lag", "input_delay", "flexible_mode", "backlash", "added_inertia"),
    separating_experiment=(
        "record one signal through both channels at once; or strike the machine: nothing answers before it "
        "is struck"
    ),
)

SENSOR_SCALE = Effect(
    id="sensor_scale",
    kind="output",
    title="sensor scale that is off",
    equation="y → (1 + e) y",
    law=lambda at: at.p.e * at.signal,
    parameters=(
        EffectParameter(
            "e", ONE, "relative error of the scale", guess=0.01, lower=-0.3, upper=0.3, nests=True
        ),
    ),
    source="Fraden (2016), Handbook of Modern Sensors, 5th ed., ch. 3 (calibration error)",
    pattern=(
        "proportional to the output itself, at rest too; a machine's inertia, where it is free, absorbs it"
    ),
    look_alikes=("input_gain", "linear_stiffness", "sensor_offset", "sensor_nonlinearity"),
    separating_experiment="compare the output with a gauge at two known positions, or with a second sensor",
)

SENSOR_OFFSET = Effect(
    id="sensor_offset",
    kind="output",
    title="sensor offset",
    equation="y → y + b",
    law=lambda at: at.p.b,
    parameters=(EffectParameter("b", EFFORT, "what the sensor reads at zero", guess=0.0, nests=True),),
    source="Fraden (2016), Handbook of Modern Sensors, 5th ed., ch. 3 (offset error)",
    pattern=(
        "a constant on the output that moves nothing; where only differences of the output matter (a "
        "position that is integrated) no record shows it"
    ),
    look_alikes=("offset", "sensor_scale", "sensor_nonlinearity"),
    separating_experiment="read the sensor with the machine known to be at zero, before and after the run",
)
