"""Fits maps of an object's normals and materials to photographs of it by one still camera."""
