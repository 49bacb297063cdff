"""Shadow maps: pictures of depths that a light sees, in which points are looked up later."""
