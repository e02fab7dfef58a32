"""The same landmarks digitised again: how precise they are, and what that says of the warp."""
