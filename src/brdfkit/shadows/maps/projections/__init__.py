"""Projections: the ways in which a light's shadow map covers the scene; one file each.

Each file has a function `make_projection(placement, ...)`. It returns a `Projection`, whose map
encloses what the camera of the `Placement` may see, and what may cast shadows on it. The further
arguments are declared in `SETTINGS`, see `techniques.py`.
"""
