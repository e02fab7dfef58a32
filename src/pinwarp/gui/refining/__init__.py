"""Refine to surface: asked for in a panel, seen level by level, checked."""
