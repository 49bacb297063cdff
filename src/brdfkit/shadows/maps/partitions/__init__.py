"""Partitions, the ways to divide a scene among several maps; each file here is a partition.

Each file has a function `make_partition(setup, ...)`, which returns the `Partition` of a `Setup`.
More arguments are its `SETTINGS`.
"""
