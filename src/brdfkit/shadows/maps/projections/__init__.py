"""Projections, the ways in which a light sees a scene; each file here is a projection.

Each file has a function `make_projection(placement, ...)`, which returns the `Projection` of a
`Placement` that encloses the placement's body. Its other arguments are the file's `SETTINGS`, see
`techniques.py`.
"""
