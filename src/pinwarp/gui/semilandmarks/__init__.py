"""Semilandmarks: curves and patches drawn on the source, seen on both bones, listed."""
