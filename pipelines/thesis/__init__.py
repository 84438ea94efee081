"""The thesis' experiments, tables and figures beside ours."""
