"""``FitSettings``: how a model is fitted to records."""

from __future__ import annotations

from dataclasses import dataclass

from hybridid.simulation.integrators import INTEGRATORS

METHODS = ("gauss_newton", "multiple_shooting")
HESSIANS = ("gauss_newton", "exact")
STARTS = ("regression", "guess")
INITIAL_STATES = ("estimated", "measured")


@dataclass(frozen=True)
class FitSettings:
    """How to fit.

    ``horizon`` (samples; None: the whole record) is how long a simulation runs before it
    starts anew from an initial state of its own; ``interval`` (samples) is the shooting
    interval inside it. ``horizon=None, interval >= n`` is single shooting, ``horizon=None``
    multiple shooting, ``horizon = N`` N-step prediction. ``continuation`` gives the
    smoothing of sign(v) in multiples of each port's epsilon, from coarse to the declared
    one. ``substeps`` None chooses as many as the integrator needs, and more if the fit ends
    where more are needed.

    Raises:
        ValueError: if a setting is outside what is allowed.
    """

    method: str = "gauss_newton"
    horizon: int | None = None
    interval: int = 100
    hessian: str = "exact"
    integrator: str = "rk4"
    substeps: int | None = None
    continuation: tuple[float, ...] = (10.0, 3.0, 1.0)
    starts: int = 1
    start: str = "regression"
    initial_state: str = "estimated"
    max_iterations: int = 100
    tolerance: float = 1e-8
    seed: int = 0

    def __post_init__(self) -> None:
        _one_of("method", self.method, METHODS)
        _one_of("hessian", self.hessian, HESSIANS)
        _one_of("integrator", self.integrator, tuple(INTEGRATORS))
        _one_of("start", self.start, STARTS)
        _one_of("initial_state", self.initial_state, INITIAL_STATES)
        for name, least in (("interval", 2), ("starts", 1), ("max_iterations", 1)):
            if getattr(self, name) < least:
                raise ValueError(f"estimator.{name} is {getattr(self, name)}: at least {least}")
        if self.horizon is not None and self.horizon < 2:
            raise ValueError(
                f"estimator.horizon is {self.horizon}: at least 2 samples, or null for the whole record"
            )
        if self.substeps is not None and self.substeps < 1:
            raise ValueError(f"estimator.substeps is {self.substeps}: at least 1, or null for automatic")
        if not self.continuation or self.continuation[-1] != 1.0 or min(self.continuation) < 1.0:
            raise ValueError(
                "estimator.continuation must end with 1 (the declared epsilon) and not go below it"
            )
        if not self.tolerance > 0:
            raise ValueError(f"estimator.tolerance is {self.tolerance}: must be positive")


def _one_of(name: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise ValueError(f"estimator.{name} is {value!r}, allowed: {', '.join(allowed)}")
