"""Filters: the ways to read the visibility of a light from a shadow map; one file each.

Each file has a class `Lookup(depths, ...)`. `depths` (resolution, resolution) are those that the
light sees. Its method `visibility(point)` returns the share of the light, in [0, 1], that reaches a
`MapPoint`. Its further arguments are declared in `SETTINGS`, see `techniques.py`. A filter whose
map holds something else than depths has its own function `render_map(scene, projection,
resolution)` in place of `render_depths`.
"""
