"""The stage ``plot``: the figures of a fitted and validated model."""
