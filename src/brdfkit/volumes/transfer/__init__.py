"""Transfer functions: what a volume's values mean to light, in files, presets and renderers.

`transfer_function.py` is one; `conversions.py` makes it of opacities (`opacity.py`), colour maps
(`colour_maps.py`) and boundaries (`boundaries.py`), and `files.py` and `slicer_presets.py` read it.
`windows.py` scales it to a volume. For renderers, `lookup.py` is its texture, `preintegration.py`
its means between two values, and `block_bounds.py` its bounds within blocks of voxels.
"""
