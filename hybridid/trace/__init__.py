"""Trace: from residual to named effect to better model, with evidence."""
