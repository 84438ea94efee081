"""MLflow: every command is a run, kept until the server takes it."""
