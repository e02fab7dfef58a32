"""Bytes to core and back: meshes, sessions and the landmark files of other programs."""
