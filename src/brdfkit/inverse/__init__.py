"""Estimates parameters from pictures: `refine` of whole scenes, `svbrdf` of flat samples."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["photographs"])
