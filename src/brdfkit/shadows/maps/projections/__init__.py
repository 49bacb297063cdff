"""Projections, by which a light sees a scene; a file is a projection, and is found by its name.

Each file has a function `make_projection(placement, ...)`, which returns the `Projection` of a
`Placement` that encloses the placement's body. Its other arguments are the file's `SETTINGS`, see
`techniques.py`.
"""
