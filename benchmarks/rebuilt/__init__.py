"""Rows of a table of wrong verdicts, rebuilt on simulated machines of the same kind; load friction."""
