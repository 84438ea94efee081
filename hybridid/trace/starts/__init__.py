"""Where a refit begins, so that it does not end in a wrong valley."""
