"""Rays through volumes: the volume's box, values between voxels, isosurfaces, largest values."""
