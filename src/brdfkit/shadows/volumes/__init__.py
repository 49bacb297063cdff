"""Shadow volumes: silhouettes, extruded away from the light, that enclose all that is dark."""
