"""The parts of the torture, in the order of the page."""

from __future__ import annotations

from benchmarks.torture import disks, endurance, inputs, kills, properties, received, secrets, stores
from benchmarks.torture.bench import Part

PARTS: tuple[Part, ...] = (
    inputs.PART, properties.PART, received.PART, kills.PART, disks.PART, stores.PART, endurance.PART,
    secrets.PART,
)  # fmt: skip
