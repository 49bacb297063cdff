"""Reads what a user gives to `render`: materials, scenes, meshes, fields and environment maps."""
