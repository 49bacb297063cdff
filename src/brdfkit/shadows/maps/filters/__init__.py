"""Filters: the ways to read the visibility of a light from a shadow map; one file each.

Each file has a class `Lookup(depths, ...)`, where `depths` (resolution, resolution) is the map that
`render_depths` makes. The method `visibility(point)` returns the share of the light, in [0, 1],
that reaches a `MapPoint`. The further arguments of `Lookup` are declared in `SETTINGS`, see
`techniques.py`. A filter that needs another map than these depths has a function
`render_map(scene, projection, resolution)`, which replaces `render_depths`.
"""
