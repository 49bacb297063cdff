"""Estimates parameters from pictures.

`refine` finds parameters of a scene, and `svbrdf` maps (textures) of a flat sample.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["photographs"])
