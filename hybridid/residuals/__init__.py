"""Residual models: networks for the error of the physical model, on its output or inside its equations."""
