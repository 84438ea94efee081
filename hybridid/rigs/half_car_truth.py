"""The truth of the virtual vehicle: the half-car's masses and struts, its driver, and undeclared effects.

Source: thesis Eqs. 4-1 to 4-14, Tables 4.1 and 4.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hybridid.rigs.contact_laws import WHEEL_LIFT_OFF
from hybridid.rigs.law_library import STIFFNESS, VISCOUS
from hybridid.rigs.laws import Planted, RigError
from hybridid.rigs.machine import Machine
from hybridid.rigs.road import Driver
from hybridid.rigs.truth import PlantedAt, at

G = 9.81  # m/s^2
PORTS = ("front_suspension", "rear_suspension", "front_tyre", "rear_tyre")


@dataclass(frozen=True)
class HalfCarTruth:
    """The vehicle of Tables 4.1 and 4.2 (except k_t) with their names and units, and its undeclared effects.

    ``lift_off``: a tyre cannot pull. ``wander`` and ``sag`` belong to the ``Driver``. Between instants
    ``road_step`` [s] apart, the wheels follow straight lines; the model uses those of 0.01 s.
    """

    m_c: float = 1250.0
    l_f: float = 1.5
    l_r: float = 1.6
    m_f: float = 30.0
    m_r: float = 30.0
    I_yy: float = 2441.0
    k_f: float = 22223.0
    k_r: float = 52916.0
    c_f: float = 2273.6
    c_r: float = 1938.6
    k_t: float = 5.2e5
    lift_off: bool = False
    wander: float = 0.0
    sag: float = 0.0
    road_step: float = 0.01
    planted: tuple[PlantedAt, ...] = ()

    def __post_init__(self) -> None:
        for name in ("m_c", "l_f", "l_r", "m_f", "m_r", "I_yy", "k_t", "road_step"):
            if not getattr(self, name) > 0:
                raise RigError(f"half-car rig: {name} is {getattr(self, name):g}, must be above 0")
        self.driver, self.machine  # noqa: B018 - their own checks

    @property
    def driver(self) -> Driver:
        """The driver, who sets the true speed."""
        return Driver(wander=self.wander, sag=self.sag)

    @property
    def static_loads(self) -> tuple[float, float]:
        """Static loads of the front and the rear tyre [N]."""
        chassis = self.m_c * G / (self.l_f + self.l_r)
        return chassis * self.l_r + self.m_f * G, chassis * self.l_f + self.m_r * G

    @property
    def machine(self) -> Machine:
        """Coordinates (z_c, theta, z_f, z_r), driven through the tyres by (u_f, u_r); a contact a port."""
        directions = (
            (-1.0, self.l_f, 1.0, 0.0, 0.0, 0.0),
            (-1.0, -self.l_r, 0.0, 1.0, 0.0, 0.0),
            (0.0, 0.0, -1.0, 0.0, 1.0, 0.0),
            (0.0, 0.0, 0.0, -1.0, 0.0, 1.0),
        )
        laws = tuple((*self._own(port), *self._planted(port)) for port in PORTS)
        mass = np.diag([self.m_c, self.I_yy, self.m_f, self.m_r])
        return Machine(tuple(map(tuple, mass.tolist())), ((),) * 4, directions, laws, prescribed=2)

    def _own(self, port: str) -> tuple[Planted, ...]:
        front = port.startswith("front")
        if port.endswith("suspension"):
            k, c = (self.k_f, self.c_f) if front else (self.k_r, self.c_r)
            return STIFFNESS(k=k, q_0=0.0), VISCOUS(f_v=c)
        tyre = STIFFNESS(k=self.k_t, q_0=0.0)
        load = self.static_loads[0 if front else 1]
        return (tyre, WHEEL_LIFT_OFF(k=self.k_t, d=load / self.k_t)) if self.lift_off else (tyre,)

    def _planted(self, port: str) -> tuple[Planted, ...]:
        return tuple(one.what for one in self.planted if one.port == port)


# Dampers that are stiffer in rebound, springs that harden, dry friction of the rear leaf springs, tyres that
# leave the road, a driver who loses some speed on the bump.
DEFAULT = HalfCarTruth(
    lift_off=True,
    wander=0.01,
    sag=0.08,
    road_step=0.001,
    planted=(
        at("front_suspension", "asymmetric_damper", difference=2000.0, knee=0.05),
        at("front_suspension", "cubic_stiffness", k_3=8e5, q_0=0.0),
        at("rear_suspension", "asymmetric_damper", difference=1800.0, knee=0.05),
        at("rear_suspension", "cubic_stiffness", k_3=1.5e6, q_0=0.0),
        at("rear_suspension", "coulomb", f_c=200.0),
    ),
)
