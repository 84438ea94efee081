"""The exit codes of a command. A signal that ends it gives another one: ``interrupt.Interrupted.code``."""

FAILED = 1
WRONG_REQUEST = 2
NOT_CONVERGED = 3
"""All results are written, but the fit has not converged."""
WRONG_MODEL = 4
"""All results are written, but the fitted model is wrong."""
