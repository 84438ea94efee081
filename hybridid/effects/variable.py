"""What a learned effort or flow may depend on, by name. No slow module is imported: configs read this."""

from __future__ import annotations

from typing import Literal

Variable = Literal[
    "velocity",
    "position",
    "time",
    "load",
    "recent speed",
    "recent load",
    "bristle deflection",
    "input",
    "level",
]
"""A quantity of the port, the time, a state with memory, or an input or channel of the model (``input``)."""
