"""Shadow maps: pictures of the depths that a light sees, which tell whether a point is lit."""
