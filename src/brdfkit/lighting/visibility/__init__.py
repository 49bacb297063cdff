"""Visibility: shadow rays against the convex parts of meshes, which may move between pictures.

`decomposition.py` cuts a mesh into convex parts, by `pieces.py`, and by coacd in
`coacd_process.py`. `hull.py` has a part's hull, `plane_map.py` stores its faces by direction,
`convex_ray.py` finds where a ray enters it, and `hierarchy.py` finds the parts that a ray may hit.
`occluders.py` combines these. `casters.py` finds the shapes and parts of a scene that cast shadows,
and `shadowed_light.py` multiplies filtered light by its visible share.
"""
