"""The table of landmarks."""
