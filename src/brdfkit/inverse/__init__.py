"""Finds numbers from pictures: of whole scenes by `refine`, of flat samples by `svbrdf`."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["photographs"])
