"""Projections: the ways in which a light's shadow map covers the scene; one file each.

Each file has a function `make_projection(placement, ...)`, which returns the `Projection` of a
`Placement` that encloses the placement's body. Its further arguments are declared in `SETTINGS`,
see `techniques.py`.
"""
