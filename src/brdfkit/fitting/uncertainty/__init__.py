"""The uncertainty of a fit: the bootstrap, loss profiles, predictions and their errors.

Users reach the four functions as `brdfkit.uncertainty`. `isotropic_limit.py` estimates, for the
notes of a fit, the least error that an isotropic model can have on an anisotropic material.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
