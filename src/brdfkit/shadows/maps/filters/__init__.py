"""Filters, the ways to look up a shadow map; each file here is a filter.

Each file has a class `Lookup(depths, ...)` of the depths (resolution, resolution) that the light
sees, with a method `lit_share(point)`: the share of the light, in [0, 1], at a `MapPoint`.
`techniques.py` describes its `SETTINGS`. A file whose map holds something else has a function
`render_map(scene, projection, resolution)` in place of `render_depths`.
"""
