"""What speaks against taking a verdict at its word."""
