"""The warp of a session, and what it predicts."""
