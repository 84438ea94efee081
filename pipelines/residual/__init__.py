"""The stage ``residual``: a network on the error of the gray box."""
