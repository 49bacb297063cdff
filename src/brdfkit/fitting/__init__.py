"""The verbs of fitting: `fit`, `compare`, and what ranks, repeats and doubts fits.

The numbers behind them, which know no `Measured`, are in `brdfkit.regression`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["uncertainty"])
