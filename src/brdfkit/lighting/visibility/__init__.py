"""What stands between two points: convex parts of meshes, and rays that ask them."""
