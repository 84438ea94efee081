"""How fast fits, simulations, traces and commands are, beside other ways to the same result."""
