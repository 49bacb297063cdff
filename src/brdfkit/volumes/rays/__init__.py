"""Rays through volumes: their box, values between voxels, crossings and largest values."""
