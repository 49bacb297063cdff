"""Environment maps as files: read, audited, and converted from one convention to another.

`map_files.py` reads and writes them; `layouts.py` and `cubes.py`: where in a picture a direction
lies; `conventions.py`: which direction of the world that is, by the names of programs;
`resampling.py` and `converting.py` turn one into another; `compass.py` draws the map that shows
what a program does; `auditing.py`, `spread.py`, `report.py` and `picture.py` are what `brdfkit info
MAP.exr` tells.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
