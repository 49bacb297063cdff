"""Shadows by maps, by volumes and by both, and their comparison by `compare`."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
