"""Whether a model meets the sensors' noise on the fitted and the held-out horizons together.

The held-out horizons share the parameters of one fit. What the noise of the fitted horizons has done to these
is the same error in all of them. Where the held-out motion is much larger, it exceeds the noise, and the
horizons are not independent evidence of it: an effect that happens to bend the parameters nearer to the truth
lowers the error in most of them.

So where a model meets the noise on the horizons it is fitted to, and not on the held-out ones, it is fitted
to all of them. If it then meets the noise on both, one set of parameters explains every horizon, and nothing
is missing in either. A few parameters cannot hide an effect among thousands of samples.

Source: Chow (1960), Econometrica 28(3), 591-605: whether two samples obey one regression is judged by what
one fit to both leaves.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit


def meets_noise_together(base: Refit, context: Context) -> bool:
    """Whether the model of ``base``, fitted to all horizons, leaves no more than the noise on either side."""
    if not _meets_noise_where_fitted(base, context):
        return False
    split = context.split
    every = replace(split, fitted=tuple(sorted({*split.fitted, *split.held_out})))
    together = context.one(refit_if_possible, base.model, every, [base.values], base, base.numerics)
    return (
        together is not None
        and context.meets_noise(together.score)
        and _meets_noise_where_fitted(together, context)
    )


def _meets_noise_where_fitted(found: Refit, context: Context) -> bool:
    """Whether the error of ``found`` on the horizons it is fitted to is that of the sensors' noise, in each
    output."""
    return bool(np.all(found.fitted_rmse <= context.rules.near_floor * context.noise.beside(found.score)))
