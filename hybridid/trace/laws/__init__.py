"""Laws that no effect of the library has."""
