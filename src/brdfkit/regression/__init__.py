"""The numerical part of a fit: finds the parameters of a BRDF model that best meet samples.

It needs neither files nor Mitsuba. `regression.py` runs the steps of a fit one after the other, and
`result.py` defines `Fit`, the result. The folders, from the ground up:

- `losses/`: the losses E, the errors that a fit can minimise.
- `problem/`: the squared loss E² of a model on samples or pixels, with derivatives. `columns.py`
  evaluates the lobes of a model on blocks of samples (`blocks.py`), `sums.py` adds the results up,
  `expansion.py` makes a quadratic approximation of E² from the sums, `problem.py` combines these
  files, and `folding.py` computes the sums faster for tables.
- `search/`: Levenberg-Marquardt searches from many starts, and a second search that corrects a
  fit with a wrong albedo (`albedo.py`).
- `solvers/`: this and other search algorithms as objects for users, and constraints.
- `robust/`: repeated fits that reduce the weight of outliers.

`certainty.py` estimates standard errors of the parameters from `certainty_scores.py`, and
`certainty_notes.py` describes parameters that the data do not determine. `measurement_noise.py`
weights samples by their standard errors, `refitting.py` repeats a fit from its solution, and
`profiling.py` follows the least loss while one parameter changes.
"""

from brdfkit.regression.losses.loss import Loss as Loss
from brdfkit.regression.losses.named_losses import to_loss as to_loss
from brdfkit.regression.losses.picture import Picture as Picture
from brdfkit.regression.regression import regress as regress
from brdfkit.regression.result import Fit as Fit
