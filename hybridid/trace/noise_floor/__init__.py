"""How near a model comes to the least error that noise and simulation leave."""
