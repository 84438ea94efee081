"""The stage ``residual``: a network on what the gray box leaves."""
