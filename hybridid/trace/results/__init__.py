"""``Trace``: what a trace found, as plain typed data."""
