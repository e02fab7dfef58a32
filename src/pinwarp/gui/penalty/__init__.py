"""The warping penalty: slider, curve, comparison, snapshots."""
