"""The user guide: pages that are shipped with the program, searched and shown by Qt."""
