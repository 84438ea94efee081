"""``FitSettings``: how a model is fitted to records."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hybridid.settings.bounds import check
from hybridid.settings.choices import AskedIntegrator, InitialState
from hybridid.settings.declare import setting


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

    method: Literal["gauss_newton", "multiple_shooting"] = setting(
        "gauss_newton",
        "gauss_newton: Levenberg-Marquardt, fast; multiple_shooting: CasADi and IPOPT, as in the thesis",
    )
    loss: Literal["squared", "huber"] = setting(
        "squared",
        "squared: least squares; huber: errors beyond 1.345 standard deviations count linearly, for records "
        "with outliers (gauss_newton)",
    )
    horizon: int | None = setting(
        None,
        "how long the model runs free before it starts anew",
        unit="samples",
        least=2,
        null="the whole record",
    )
    interval: int = setting(100, "length of a shooting interval (multiple_shooting)", unit="samples", least=2)
    hessian: Literal["gauss_newton", "exact"] = setting(
        "exact",
        "second derivatives of the cost (multiple_shooting); gauss_newton may not converge where the model "
        "leaves a large error",
    )
    integrator: AskedIntegrator = setting(
        "auto",
        "rk4: Runge-Kutta of order 4; rodas3: implicit, for stiff models; auto: rk4, or rodas3 where rk4 "
        "needs more than 50 steps a sample",
    )
    substeps: int | None = setting(
        None, "integrator steps in each sample", least=1, null="as many as stability needs"
    )
    continuation: tuple[float, ...] = setting(
        (10.0, 3.0, 1.0),
        "smoothing of sign(v) in the stages of a fit, in multiples of each port's epsilon; the last is 1",
        least=1,
        some=True,
    )
    starts: int = setting(1, "how many starts; the best fit is kept", least=1)
    start: Literal["regression", "guess"] = setting(
        "regression", "where the first start lies: at a regression on smoothed derivatives, or at the guesses"
    )
    initial_state: InitialState = setting("estimated", "the state in which each horizon starts")
    max_iterations: int = setting(100, "iterations at most", least=1)
    # two costs within a thousandth count as one optimum: a fit that ends sooner has not found it
    tolerance: float = setting(1e-8, "relative change of the cost at which the fit ends", above=0, most=1e-3)
    seed: int = setting(0, "seed of the random starts", least=0, most=2**63 - 1)

    def __post_init__(self) -> None:
        check(self, "estimator")
        if self.loss == "huber" and self.method != "gauss_newton":
            raise ValueError(
                "estimator.loss=huber needs estimator.method=gauss_newton, which reweights its steps"
            )
        if self.continuation[-1] != 1.0:
            raise ValueError(
                "estimator.continuation must end with 1 (the declared epsilon) and not go below it"
            )
