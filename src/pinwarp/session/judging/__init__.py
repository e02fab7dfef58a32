"""How good a warp is, and what says so."""
