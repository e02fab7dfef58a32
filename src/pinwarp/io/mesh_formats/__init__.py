"""Mesh files, one module per format; :mod:`pinwarp.io.meshes` is the way in."""
