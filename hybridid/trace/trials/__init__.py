"""Candidates and pairs of them, each refitted and judged."""
