"""What differs from recording to recording."""
