"""Losses: the error E that a fit minimises.

`named` holds those that have a name. `Loss` makes one of a formula, `Picture` compares rendered
pictures. Users reach them as `brdfkit.losses`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
