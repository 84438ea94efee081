"""Measured record + believed physics -> a model that is accurate and still physics.

Importable in a notebook: nothing here reads a config, logs a run or prints.
Imports run one way: declarations <- plants, effects <- model <- simulation,
estimators, validation.
"""

from hybridid.private import keep_numba_private

__version__ = "0.1.0"

keep_numba_private()  # before anything imports numba
