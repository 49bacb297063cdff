"""One projection of a shadow map a file, by the file's name; a new file is found by being there.

Each has `projection(placement, ...)`, the `Projection` of a `Placement`, which holds its body; the
other arguments are the file's `SETTINGS`, see `techniques`.
"""
