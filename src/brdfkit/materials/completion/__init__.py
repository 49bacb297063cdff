"""Completes materials that were measured at few directions, by what materials have in common.

`completing.py` is `complete`, `planning.py` chooses directions to measure, `prior_making.py` makes
a prior. A prior is a linear model of logarithms (`prior.py`) in the cells of `prior_cells.py`;
`posterior.py` combines it with measured values (`observations.py`).
"""

from brdfkit.materials.completion.completing import complete

__all__ = ["complete"]
