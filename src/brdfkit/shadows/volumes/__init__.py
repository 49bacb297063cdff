"""Shadow volumes: silhouettes, pushed away from the light, that enclose all that is dark."""
