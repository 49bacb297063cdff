"""The numbers behind a fit: a model regressed on samples, without files and without Mitsuba.

`regression.py` runs the steps of a fit one after the other, and `result.py` is `Fit`, its result.
The folders, from the ground up:

- `losses/`: the error E that a fit minimises.
- `problem/`: E² of a model on samples or pixels, with derivatives. `columns.py` evaluates the lobes
  of a model on `blocks.py` of samples, `sums.py` adds them up, `expansion.py` makes E² to second
  order from the sums, `problem.py` combines these, and `folding.py` is a faster way for tables.
- `search/`: Levenberg-Marquardt steps from many starts, and a second search that corrects the
  albedo of a fit (with `light.py`).
- `solvers/`: this and other algorithms as objects for users, and constraints.
- `robust/`: repeated fits that reduce the weight of outliers.

`certainty.py` estimates standard errors, `measurement_noise.py` uses those of a measurement,
`refitting.py` repeats a fit from its end, and `profiling.py` profiles its loss over a parameter.
"""

from brdfkit.regression.losses.loss import Loss as Loss
from brdfkit.regression.losses.named_losses import to_loss as to_loss
from brdfkit.regression.losses.picture import Picture as Picture
from brdfkit.regression.regression import regress as regress
from brdfkit.regression.result import Fit as Fit
