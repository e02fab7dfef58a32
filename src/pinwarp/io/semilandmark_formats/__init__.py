"""Landmarks with curves and patches of semilandmarks, a module for each family of programs."""
