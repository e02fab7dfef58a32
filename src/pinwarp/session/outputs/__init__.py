"""What leaves a session."""
