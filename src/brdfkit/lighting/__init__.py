"""Lighting by environment maps: reading, sampling and filtering the maps, and their shadows."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["environments"])
