"""The two viewports, their cameras and their controls."""
