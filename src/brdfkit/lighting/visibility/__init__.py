"""Visibility: shadow rays against the convex parts of meshes, which may move between pictures.

`decomposition.py` cuts a mesh into parts (by `pieces.py` and `holes.py`, and coacd in
`coacd_process.py`), each a hull in `hull.py`. `plane_map.py` stores the faces of a part by
direction, `convex_ray.py` finds where a ray enters it, and `hierarchy.py` finds the parts that a
ray may hit; `occluders.py` brings them together. `casters.py` finds what casts shadows in a scene,
and `shadowed_light.py` dims filtered light by what is hidden.
"""
