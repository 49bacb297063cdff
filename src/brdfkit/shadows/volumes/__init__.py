"""Shadow volumes: silhouettes are extruded away from the light and enclose all that is dark."""
