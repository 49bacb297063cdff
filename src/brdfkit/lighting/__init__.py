"""Light from environments: how maps are cut, sampled and filtered; spherical Gaussians."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["environments"])
