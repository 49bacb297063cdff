"""Volumes: values on a grid of voxels, from files or synthetic, and their rendering.

`volume.py` defines the class `Volume`. `loading.py` reads a volume from a file (`formats/`), with
fewer voxels if the user wishes (`downsampling.py`), or makes a synthetic one (`made/`). `transfer/`
has transfer functions, which map values to colour and extinction. `scene_dictionary.py` converts
both to dictionaries for Mitsuba. `summary/` describes a volume for `brdfkit info`. For renderers,
`rays/` finds isosurfaces and largest values along rays, and `light/` collisions of light.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
