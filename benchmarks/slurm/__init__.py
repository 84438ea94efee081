"""Studies on a Slurm of one node: a job is killed on purpose, and nothing else may be lost."""
