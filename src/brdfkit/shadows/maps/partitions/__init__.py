"""One way to share a scene among several maps a file, by the file's name; found by being there.

Each has `partition(scene, placement, project, resolution, ...)`, the `Partition` of a `mi.Scene`
under a `Placement`: `project(placement)` makes the `Projection` of a map, `resolution` is how many
texels it has along a side. More arguments are its `SETTINGS`.
"""
