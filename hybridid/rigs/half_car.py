"""The virtual vehicle: a half-car that runs over a bump, recorded by an inertial sensor (thesis, Chapter 4).

    m_c z_c'' = F_f + F_r,    I_yy theta'' = l_r F_r - l_f F_f
    m_f z_f'' = tyre - F_f,   F_f = k_f d + c_f d' + planted laws,   d = z_f - (z_c - l_f theta)

The rear axle has the same equations. Heights are measured from the static equilibrium on a level road. The
wheels follow the road at the true speed. The record's road inputs u_f and u_r are the known part of it: the
shape of the bump at the nominal speed, delayed by the wheelbase at the rear. The record has 100 Hz; pitch
rate and vertical acceleration contain noise, bias and engine vibration. The accelerometer gives the mean
over its sampling interval.

Two choices are ours. The dimensions of the type-A bump of TOP 01-1-011B are in the thesis' Figure 4.1,
which its text does not contain, and we did not find them elsewhere: ``BUMP`` is a sine-squared hump. The
first 2.6 s over it have nearly the standard deviations that RMSE and R² of Table 4.3 imply, 0.174 m/s and
0.147 rad/s. k_t is that of two tyres side by side, 5.2e5 N/m: with the 5.1e6 N/m of Table 4.2, the wheels
would hop at 66 Hz, which a record of 100 Hz filtered at 5 Hz cannot distinguish from any other stiff tyre.

Source: thesis Eqs. 4-1 to 4-14, Section 4.2, Tables 4.1 and 4.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Channel
from hybridid.rigs.half_car_truth import DEFAULT, PORTS, HalfCarTruth
from hybridid.rigs.machine import Motion
from hybridid.rigs.rig import Experiment, Rig
from hybridid.rigs.road import Bump, Sensor

Array = NDArray[np.float64]
STEPS = 10  # of the truth a sample
TOLERANCE = 1e-8  # of such a step
BUMP = Bump(height=0.12, length=1.8)
ACCELEROMETER = Sensor(noise=0.02, bias=0.05, vibration=0.3)  # m/s^2
GYRO = Sensor(noise=0.002, bias=0.004, vibration=0.01)  # rad/s


@dataclass(frozen=True)
class HalfCarConfig:
    """All settings of a run of the virtual vehicle, in SI units. The bump begins after ``lead_in`` [s]."""

    truth: HalfCarTruth = DEFAULT
    bump: Bump = BUMP
    identification: float = 20 / 3.6  # m/s, also the next
    validation: float = 15 / 3.6
    lead_in: float = 0.3
    accelerometer: Sensor = ACCELEROMETER
    gyro: Sensor = GYRO


@final
class HalfCarRig(Rig):
    """A vehicle over a bump, simulated. Runs: ``identification`` at 20 km/h, ``validation`` at 15 km/h."""

    config: HalfCarConfig
    name = "half_car"
    runs = ("identification", "validation")
    ports = PORTS
    sampling_time = 0.01
    full_duration = 6.0
    input_channels = (
        Channel("u_f", "m", "foh", "road height under the front wheel, at the nominal speed"),
        Channel("u_r", "m", "foh", "road height under the rear wheel, at the nominal speed"),
    )
    output_channels = (
        Channel("vertical_acceleration", "m/s²", meaning="chassis vertical acceleration, upwards"),
        Channel("pitch_rate", "rad/s", meaning="chassis pitch rate, rear upwards"),
    )
    auxiliary_channels = ()

    def __init__(self, config: HalfCarConfig | None = None) -> None:
        super().__init__(config or HalfCarConfig())

    def summary(self) -> str:
        truth = self.config.truth
        known = (("m_c", "kg"), ("I_yy", "kg m^2"), ("k_f", "N/m"), ("k_r", "N/m"), ("c_f", "N s/m"))
        numbers = (*known, ("c_r", "N s/m"), ("k_t", "N/m"))
        own = ", ".join(f"{name} {getattr(truth, name):g} {unit}" for name, unit in numbers)
        speed = f"speed wanders by {100 * truth.wander:g} % and sags by {100 * truth.sag:g} %"
        tyres = f"tyres {'leave' if truth.lift_off else 'never leave'} the road"
        planted = ", ".join(one.said() for one in truth.planted) or "nothing"
        return f"{own}, {speed}, {tyres}, planted: {planted}"

    def perform(self, run: str, time: Array, generator: np.random.Generator) -> Experiment:
        config, n, dt = self.config, len(time), self.sampling_time
        nominal = getattr(config, run)
        driving, shaking, pitching = generator.spawn(3)
        # the last interval of the accelerometer ends half a sample after the record
        fine: Array = np.arange(n * STEPS, dtype=np.float64) * (dt / STEPS)
        speed = config.truth.driver.speed(nominal, fine - config.lead_in, dt / STEPS, driving)
        travelled = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])) * dt / STEPS])
        road = self._held(fine, self._road(travelled, nominal))
        states = self._driven(road)
        samples = slice(0, n * STEPS, STEPS)
        heights, rates = states[samples, :4], states[samples, 6:10]
        recorded = self._road(nominal * time, nominal)
        acceleration = _mean_rate(states[:, 6], n, dt)
        return Experiment(
            time,
            inputs={"u_f": recorded[:, 0], "u_r": recorded[:, 1]},
            outputs={
                "vertical_acceleration": config.accelerometer.read(acceleration, time, shaking),
                "pitch_rate": config.gyro.read(rates[:, 1], time, pitching),
            },
            truth={
                "vertical_velocity": rates[:, 0],
                "pitch_rate": rates[:, 1],
                "speed": speed[samples],
                **dict(zip(("z_c", "theta", "z_f", "z_r"), heights.T, strict=True)),
                **dict(zip(("u_f", "u_r"), road[samples].T, strict=True)),
            },
        )

    def _road(self, travelled: Array, nominal: float) -> Array:
        """Height (n, 2) under the front and the rear wheel after ``travelled`` (n,) [m]."""
        front = travelled - nominal * self.config.lead_in
        wheelbase = self.config.truth.l_f + self.config.truth.l_r
        return np.column_stack([self.config.bump(front), self.config.bump(front - wheelbase)])

    def _held(self, fine: Array, road: Array) -> Array:
        """The road that the wheels follow: piecewise linear between instants ``road_step`` [s] apart."""
        every = max(1, round(self.config.truth.road_step / (self.sampling_time / STEPS)))
        return np.column_stack([np.interp(fine, fine[::every], column[::every]) for column in road.T])

    def _driven(self, road: Array) -> Array:
        """Positions and velocities (m, 12) of (z_c, theta, z_f, z_r, u_f, u_r) over the road (m, 2)."""
        step, none = self.sampling_time / STEPS, np.empty(0)
        motion = Motion(self.config.truth.machine, np.zeros(6), tolerance=TOLERANCE)
        states = np.zeros((len(road), 12))
        slopes = np.diff(road, axis=0, append=road[-1:]) / step
        for k in range(len(road)):
            states[k, :6], states[k, 6:] = motion.positions, motion.velocities
            motion.drive(road[k], slopes[k])
            motion.advance(step, none)
        return states


def _mean_rate(velocity: Array, n: int, dt: float) -> Array:
    """Mean acceleration (n,) over the interval of ``dt`` [s] about each sample; at rest before the first."""
    middle = velocity[STEPS // 2 :: STEPS][:n]
    return np.diff(middle, prepend=0.0) / dt


AS_DECLARED = HalfCarRig(HalfCarConfig(truth=HalfCarTruth()))
"""The vehicle without undeclared effects; only its sensors have errors."""
