"""Learned efforts: what any function of a variable could explain."""
