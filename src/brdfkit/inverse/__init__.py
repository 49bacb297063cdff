"""Estimate parameters from pictures: `refine` those of a scene, `svbrdf` maps of a flat sample."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["photographs"])
