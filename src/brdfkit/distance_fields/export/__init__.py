"""Writes distance fields as meshes, grids, JSON, Python and GLSL."""
