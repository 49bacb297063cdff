"""The numeric core of a fit: a model regressed on samples, without files and without Mitsuba.

From the ground up: `loss.py` is the error E that a fit minimises, `named_losses.py` the usual ones,
`picture.py` that of pictures. `columns.py` evaluates the lobes of a model and their derivatives, on
`blocks.py` of samples; `sums.py` adds them up, `expansion.py` makes of the sums E² to second order,
and `problem.py` all this of a model on samples (`folding.py`: quicker, on a table with a linear
loss; `pixel_problem.py`: on `pixel_blocks.py`, too, as `picture_problem.py` has them).
`levenberg_marquardt.py` searches in the bounds of `parameter_space.py`, by steps that
`box_quadratic.py` finds; `search.py` has it go from many `starting_points.py` and a `part.py` of
many samples to one end and all. This and other ways to search are the `solvers/`, where constraints
are, too. `robust.py` weighs down outliers, `robust_search.py` until weights and solution give each
other back, which `convexity.py` speeds up. `light.py` has the albedos of a fit and its data, and
`light_search.py` searches again where they differ. `certainty.py` says how certain the parameters
are. `regression.py` runs these one after the other; `result.py` is `Fit`. `refitting.py` fits again
from the end of one, and `profiling.py` follows its loss over a parameter.
"""

from brdfkit.fitting.loss import Loss as Loss
from brdfkit.fitting.named_losses import as_loss as as_loss
from brdfkit.fitting.named_losses import losses as losses
from brdfkit.fitting.picture import Picture as Picture
from brdfkit.fitting.regression import regress as regress
from brdfkit.fitting.result import Fit as Fit
