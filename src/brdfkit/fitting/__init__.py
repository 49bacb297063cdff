"""Fits BRDF models to measured materials: `fit`, `compare`, `rank`, `sweep` and `uncertainty`.

The numerical methods are in `brdfkit.regression`, which does not depend on the class `Measured`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["uncertainty"])
