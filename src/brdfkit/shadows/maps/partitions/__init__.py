"""Partitions: the ways to divide a scene among several shadow maps; one file each.

Each file has a function `make_partition(setup, ...)`, which returns the `Partition` of a `Setup`.
Its further arguments are declared in `SETTINGS`.
"""
