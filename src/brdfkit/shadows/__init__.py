"""Shadow techniques for point, spot and directional lights, and `compare`, which scores them.

Shadow maps and shadow volumes each have a folder; `hybrid.py` makes volumes from a map.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
