"""One way to look up a shadow map a file, by the file's name; a new file is found by being there.

Each has a class `Lookup(depths, ...)`, of the depths (resolution, resolution) that the light sees,
with `lit(point)`: of a `MapPoint`, the share of the light that arrives, in [0, 1]. `SETTINGS` are
described in `techniques.py`. A file whose map holds something else has a function `see(scene,
projection, resolution)`, as `depth_pass` is.
"""
