"""Partitions: the ways to divide a scene among several shadow maps; one file each.

Each file has a function `make_partition(setup, ...)`, which returns the `Partition` for a `Setup`
(scene, camera, light and projection). Its further arguments are declared in `SETTINGS`, see
`techniques.py`.
"""
