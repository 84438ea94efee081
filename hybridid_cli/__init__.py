"""The terminal: picks the command, shows progress, prints results and errors. No science."""
