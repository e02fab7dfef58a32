"""The hand: placing, moving, ghosts, the guide."""
