"""Projections: the ways in which a light's shadow map covers the scene; one file each.

Each file has a function `make_projection(placement, ...)`. It returns a `Projection` whose map
encloses all that the camera of the `Placement` may see, and all that may cast shadows on that. The
further arguments are declared in `SETTINGS`, see `techniques.py`.
"""
