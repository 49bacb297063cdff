"""Filtering of environment maps: lighting without noise by a few look-ups in a filtered map.

`sphere_filter.py` convolves a map, `paraboloid_levels.py` makes the levels of a filtered map,
`filtered_map.py` looks them up in Mitsuba, and `filtered_light.py` filters a scene's emitter. There
are two ways to light a pixel by a sum of look-ups. `filtered_sampling.py` looks up a few directions
that the BSDF draws (`bsdf_directions.py`), which `view_directions.py` stores for a grid of views.
`lobe_light.py` looks up spherical Gaussians. `scene_bsdfs.py` examines the BSDFs of a scene.
"""
