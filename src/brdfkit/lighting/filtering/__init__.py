"""Filtering of environment maps: lighting without noise by a few look-ups in a filtered map.

`sphere_filter.py` convolves a map, `paraboloid_levels.py` makes the levels of a filtered map,
`filtered_map.py` looks them up in Mitsuba, and `filtered_light.py` filters a scene's emitter. A
pixel sums look-ups in one of two ways: `filtered_sampling.py` takes a few directions drawn by the
BSDF (`bsdf_directions.py`, stored for a grid of views by `view_directions.py`), and `lobe_light.py`
takes spherical Gaussians. `scene_bsdfs.py` examines the BSDFs of a scene.
"""
