"""Transfer functions, which map a volume's values to colour and extinction.

`transfer_function.py` defines the class. `conversions.py` makes transfer functions from opacities
(`opacity.py`), colour maps (`colour_maps.py`) and boundaries between materials (`boundaries.py`).
`files.py` and `slicer_presets.py` read files, and `windows.py` scales a transfer function to a
volume. For renderers, `lookup.py` makes a texture, `preintegration.py` computes means between two
values, and `block_bounds.py` upper bounds in blocks of voxels.
"""
