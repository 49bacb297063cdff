"""Shadow maps: pictures of the depths that a light sees, in which receivers are looked up."""
