"""``Method``: how a problem becomes decision variables, and which solver finds them, chosen apart.

    transcription        Levenberg-Marquardt                  IPOPT
    reduced              ``gauss_newton``, the default        the same least squares, by an interior point
    multiple shooting    refused: the gaps are constraints    ``multiple_shooting``, the thesis' own

All minimise the cost of ``Problem``. They end in the same optimum where the cost has one valley within reach.
Over a long free run it may have many, and multiple shooting, whose nodes begin on the record, may end in
another one than a descent on parameters alone; then neither need be the lowest. ``elsewhere`` looks for a
lower one from a fit over short pieces, and a fit says at which costs its descents ended. Problem,
transcription and solver are kept apart as in rockit, the Rapid Optimal Control Kit (rockit-meco on PyPI).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Solution
from hybridid.estimators.ipopt import Ipopt
from hybridid.estimators.levenberg_marquardt import LevenbergMarquardt
from hybridid.estimators.multiple_shooting import MultipleShooting
from hybridid.estimators.problem import Problem
from hybridid.estimators.reduced import Reduced
from hybridid.estimators.stop import Stop, Watch

Array = NDArray[np.float64]
STOP = Stop()


@dataclass(frozen=True)
class Method:
    """A transcription and a solver.

    Raises:
        ValueError: if the solver cannot solve what the transcription makes.
    """

    transcription: Reduced | MultipleShooting
    solver: LevenbergMarquardt | Ipopt

    def __post_init__(self) -> None:
        if not isinstance(self.transcription, self.solver.solves):
            ours, theirs = type(self.solver).__name__, type(self.transcription).__name__
            raise ValueError(f"{ours} takes no constraints, and {theirs} has some: choose Reduced or Ipopt")

    def solve(
        self,
        problem: Problem,
        p: Array,
        x0: Array,
        factors: Sequence[float] = (1.0,),
        stop: Stop = STOP,
        watch: Watch | None = None,
    ) -> Solution:
        """Minimise the cost of ``problem`` from ``p`` (n_p,), ``x0`` (w, n_x), inside the bounds.

        ``factors`` multiply the smoothing widths of sign(v) (continuation): one descent for each, begun
        where the one before ended. A simulation that diverges at the start has infinite cost.
        """
        return self.solver.solve(self.transcription, problem, p, x0, factors, stop, watch)  # type: ignore[arg-type]


GAUSS_NEWTON = Method(Reduced(), LevenbergMarquardt())
"""What predictions and traces use unless told otherwise."""
MENDING = Method(Reduced(), LevenbergMarquardt(mends=True, learns=True))
"""The same for a fit: a step that fails in a few horizons is mended there, and steps learn from others."""
LEARNING = Method(Reduced(), LevenbergMarquardt(learns=True))
"""The same for its second descent: it mends no step."""
