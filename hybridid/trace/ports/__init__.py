"""What a fitted model shows at its ports: its path, and the effort that is missing there."""
