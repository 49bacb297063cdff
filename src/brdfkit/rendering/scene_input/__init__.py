"""What a user gives to be rendered: scenes, meshes, fields and maps."""
