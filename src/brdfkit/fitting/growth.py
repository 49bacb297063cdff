"""Notes how far a fit grows, beyond the measured angles, above the largest measured value."""

import numpy as np

from brdfkit.core.geometry.directions import from_angles
from brdfkit.fitting.guard import Brdf
from brdfkit.materials.extrapolation import (
    LARGEST_FIT_SHARE,
    compute_share_beyond,
    describe_reach,
)
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples

# A fit gets a note if it exceeds the largest measured value by more than this factor
LARGEST_GROWTH = 3.0
STEP = 2.5  # steps of the angles to the normal [degrees]
AZIMUTHS = np.radians([0, 30, 60, 90, 120, 150, 165, 170, 175, 178, 180])  # dense at the mirror's


def note_growth(data: Measured, samples: Samples, brdf: Brdf, max_angle: float) -> list[str]:
    """Return a list with a sentence on how large a fit becomes beyond the measured angles, if any.

    `data`: the material. `samples`: those that were fitted. `brdf`: the fit, a function of
    directions wi and wo (n, 3). `max_angle`: the largest angle of the fit [degrees].
    """
    if compute_share_beyond(data, max_angle) <= LARGEST_FIT_SHARE:
        return []
    largest = float(samples.values.mean(axis=1).max())
    theta = np.radians(np.arange(0, max_angle, STEP))
    axes = np.meshgrid(theta, theta, AZIMUTHS, indexing="ij")
    theta_i, theta_o, phi = (axis.ravel() for axis in axes)
    values = brdf(from_angles(theta_i, 0 * theta_i), from_angles(theta_o, phi)).mean(axis=1)
    row = int(np.argmax(values))
    if largest <= 0 or values[row] <= LARGEST_GROWTH * largest:
        return []
    where = f"θi {np.degrees(theta_i[row]):.3g}° and θo {np.degrees(theta_o[row]):.3g}°"
    return [
        f"angles beyond {describe_reach(data)} were not measured; there this fit reaches "
        f"{values[row] / largest:.2g} times the largest measured value, at {where}"
    ]
