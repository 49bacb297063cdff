"""Shadow maps: what a light sees as a picture of depths, in which later points are looked up."""
