"""Light from environment maps: their files, their sampling, their filtering, and shadows."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["environments"])
