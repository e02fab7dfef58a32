"""Sessions and meshes: opened, saved, recovered."""
