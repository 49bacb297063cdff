"""Partitions, the ways to divide a scene among several maps; a file is one, found by its name.

Each file has a function `make_partition(setup, ...)`, which returns the `Partition` of a `Setup`.
More arguments are its `SETTINGS`.
"""
