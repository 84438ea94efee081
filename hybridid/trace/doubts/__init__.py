"""What withdraws an accepted effect, or its name."""
