"""What leaves: landmarks, meshes, pictures, reports."""
