"""Shadow maps of moments, mean powers of depth, which bound the light that reaches a point."""
