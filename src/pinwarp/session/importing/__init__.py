"""Landmarks from files, understood before they come in."""
