"""The spline and what it works on: pure functions and frozen data; no files, no screen."""
