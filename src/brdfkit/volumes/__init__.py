"""Volumes: values on a grid of voxels, from files or synthetic, and what they mean to light.

`volume.py` is one volume. `loading.py` reads it from a file (`formats/`), with fewer voxels if the
user wishes (`downsampling.py`), or makes it (`made/`). `transfer/` has the transfer functions that
give its values colour and extinction, and `scene_dictionary.py` writes both for Mitsuba. `summary/`
describes a volume for `brdfkit info`. For renderers, `rays/` finds values, crossings and largest
values along rays, and `light/` finds where light collides in a medium.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
