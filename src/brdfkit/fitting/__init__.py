"""The numeric core of a fit: a model regressed on samples, without files and without Mitsuba.

`loss.py`: what is made small; `problem.py`: that as a function of the shape parameters, with the
weights solved inside (`weights.py`); `space.py`: where the search goes and begins; `search.py`: SQP
from one start; `robust.py`: outliers; `regression.py`: one after the other; `result.py`: a `Fit`.
"""

from brdfkit.fitting.loss import losses as losses
from brdfkit.fitting.regression import regress as regress
from brdfkit.fitting.result import Fit as Fit
