"""What a capability offers the window."""
