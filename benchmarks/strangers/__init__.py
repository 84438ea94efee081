"""Machines that hybridid has never seen, from their recordings to a report, by commands alone."""
