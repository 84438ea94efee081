"""The stage ``trace``: what the model lacks, written to files and pages."""
