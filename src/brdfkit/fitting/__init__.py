"""The verbs of fitting: `fit`, `compare`, `rank` and `sweep`, and the uncertainty of fits.

The numerics behind them, which do not know `Measured`, are in `brdfkit.regression`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["uncertainty"])
