"""Shadow volumes: solids that enclose all dark points, silhouettes extruded away from the light."""
