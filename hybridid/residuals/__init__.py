"""Residual models: networks on what the physics leaves, after its output or inside its equations."""
