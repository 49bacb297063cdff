"""The numeric core of a fit: a model regressed on samples, without files and without Mitsuba.

`loss.py`: the error E that a fit minimises; `problem.py`: E² as a function of the shape parameters,
with the best weights for each of their values (`weights.py`); `parameter_space.py`: the bounds of
the search; `starting_points.py`: where it starts; `search.py`: SQP from one start; `robust.py`:
outliers; `regression.py`: runs these one after the other; `result.py`: `Fit`.
"""

from brdfkit.fitting.loss import losses as losses
from brdfkit.fitting.regression import regress as regress
from brdfkit.fitting.result import Fit as Fit
