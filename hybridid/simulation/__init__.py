"""Simulation: fixed-step integration of a model over a record's inputs."""

from hybridid.simulation.simulate import Diverged, Trajectory, simulate

__all__ = ["Diverged", "Trajectory", "simulate"]
