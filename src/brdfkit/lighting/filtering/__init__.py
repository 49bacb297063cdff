"""Filtering of environment maps: light without noise by a few look-ups, in place of paths.

`sphere_filter.py` convolves a map, `paraboloid_levels.py` makes the levels of a filtered map,
`filtered_map.py` looks them up in Mitsuba, and `filtered_light.py` does so for a scene's emitter.
A pixel adds up look-ups in one of two ways: `filtered_sampling.py` for a few directions of its BSDF
(`bsdf_directions.py`, or for a whole grid of views `view_directions.py`), or `lobe_light.py` for
spherical Gaussians. `scene_bsdfs.py` tells what the BSDFs of a scene are like.
"""
