"""What to check."""
