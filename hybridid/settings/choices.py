"""Words to choose from that several rooms know."""

from __future__ import annotations

from typing import Literal

Integrator = Literal["rk4", "rodas3"]
"""How one step is integrated."""
AskedIntegrator = Literal["auto", "rk4", "rodas3"]
"""The same, or left open."""
InitialState = Literal["estimated", "measured"]
"""Where a free run starts: at a state that fits the record best, or at the measured one."""
View = Literal["free_run", "horizon", "loop"]
"""The whole record in one go, many short runs, or under the control law that ran the machine."""
