"""The numeric core of a fit: a model regressed on samples, without files and without Mitsuba.

From the ground up: `losses/loss.py` is the error E that a fit minimises, `losses/named_losses.py`
the usual ones, `losses/picture.py` that of pictures. `problem/columns.py` evaluates the lobes of a
model and their derivatives, on `problem/blocks.py` of samples; `problem/sums.py` adds them up,
`problem/expansion.py` makes of the sums E² to second order, and `problem/problem.py` all this of a
model on samples (`problem/folding.py`: quicker, on a table with a linear loss;
`problem/pixel_problem.py`: on `problem/pixel_blocks.py`, too, as `problem/picture_problem.py` has
them). `search/levenberg_marquardt.py` searches in the bounds of `problem/parameter_space.py`, by
steps that `problem/box_quadratic.py` finds; `search/multistart.py` has it go from many
`search/starting_points.py` and a `problem/subset.py` of many samples to one end and all. This and
other ways to search are the `solvers/`, where constraints are, too. `robust/reweighting.py` weighs
down outliers, `robust/search.py` until weights and solution give each other back, which
`robust/convexity.py` speeds up. `light.py` has the albedos of a fit and its data, and
`search/light_search.py` searches again where they differ. `certainty.py` says how certain the
parameters are. `regression.py` runs these one after the other; `result.py` is `Fit`. `refitting.py`
fits again from the end of one, and `profiling.py` follows its loss over a parameter.
"""

from brdfkit.regression.losses.loss import Loss as Loss
from brdfkit.regression.losses.named_losses import as_loss as as_loss
from brdfkit.regression.losses.picture import Picture as Picture
from brdfkit.regression.regression import regress as regress
from brdfkit.regression.result import Fit as Fit
