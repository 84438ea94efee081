"""A model fitted on the fitted horizons, and what it leaves on the others."""
