"""Partitions, the ways to divide a scene among several maps; a file is one, found by its name.

Each file has a function `make_partition(scene, placement, project, resolution, ...)`, which returns
the `Partition` of a `mi.Scene` under a `Placement`. `project(placement)` makes the projection of a
map, and `resolution` is its number of texels along a side. More arguments are its `SETTINGS`.
"""
