"""The stepwise search: which effects are accepted, and when it ends."""
