"""The light that a fit should keep: what those samples reflect that it uses."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.materials.measured import Measured
from brdfkit.regression.light import Light

# Samples beyond this angle to the normal [degrees] tell how values go on to the horizon, though
# fits leave them out; a fit that leaves out more does not trust them
USUAL = 80.0


def light_of_data(data: Measured, weights: ArrayLike | None, max_angle: float) -> Light:
    """The `Light` of the samples of a `Measured` that a fit uses.

    Parameters
    ----------
    data : Measured
        The material, in the channels of the fit.
    weights : array_like, optional
        The user's factors of the samples; those of factor 0 do not count.
    max_angle : float
        The angle to the normal [degrees] from which on samples are left out.

    Returns
    -------
    Light
        The albedos; none is known at an angle that the fit leaves out.

    Examples
    --------
    >>> light_of_data(paint, None, 80.0).known    # doctest: +SKIP
    array([ True,  True,  True, False])
    """
    if weights is None and max_angle >= USUAL:
        light = Light.of(data.albedo, data.anisotropic)
    elif data.has_lookup:  # no part of it can be asked for
        light = Light.of(data.albedo, data.anisotropic)
        light = replace(light, known=light.known & (weights is None))
    else:
        light = Light.of(_part(data, weights, max_angle).albedo, data.anisotropic)
    return replace(light, known=light.known & (np.array(light.theta_i) < max_angle))


def _part(data, weights, max_angle):
    """The samples of a `Measured` below `max_angle`, or USUAL, and of a weight above 0."""
    samples = data.samples
    good = samples.valid if max_angle >= USUAL else samples.within(max_angle)
    if weights is not None:
        good = good & (np.ravel(weights) > 0)
    how = {"channels": data.channels, "name": data.name}
    if data.is_table:
        values = data.table.values
        kept = np.where(good.reshape(values.shape[:-1])[..., None], values, np.nan)
        return Measured.from_table(kept, phi_d_period=data.table.phi_d_period, **how)
    part = samples.at(good)
    return Measured.from_samples(part.wi, part.wo, part.values, anisotropic=data.anisotropic, **how)
