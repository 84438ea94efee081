"""``sweep``: many configs at once, their networks trained together where that is faster, one table of all."""
