"""Bad inputs that were made by hand, as tables: one file for each kind of thing that a user writes."""
