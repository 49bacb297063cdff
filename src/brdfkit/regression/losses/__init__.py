"""Losses E: the errors of a model compared with measured data, which a fit minimises.

`named` contains brdfkit's losses by name, `Loss` is a loss defined by a formula, and `Picture` is a
loss that compares rendered pictures. Users import them from `brdfkit.losses`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
