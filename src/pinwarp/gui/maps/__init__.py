"""Maps over the warped source."""
