"""Landmarks from files."""
