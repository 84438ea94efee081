"""The measured league: every measured record at hand, traced with each declared effect left out in turn."""
