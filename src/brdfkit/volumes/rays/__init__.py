"""What a ray meets in a volume: values along it, the largest one, surfaces and their normals."""
