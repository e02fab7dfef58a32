"""The warp on the screen: live, judged, taken apart."""
