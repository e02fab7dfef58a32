"""What Qt paints over the picture."""
