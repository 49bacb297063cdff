"""Environment maps as files: reading, auditing, and converting between programs' conventions.

`map_files.py` reads and writes maps. `layouts.py` and `cubes.py` relate the pixels of a picture to
directions, and `conventions.py` relates these directions to the axes of a given program's world.
`resampling.py` and `converting.py` convert between conventions. `auditing.py` describes the light
of a map for `brdfkit info MAP.exr`, with numbers from `light_distribution.py` and a figure from
`audit_picture.py`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
