"""Is a planted blunder told in words before any parameter is shown as trustworthy? Simulated."""
