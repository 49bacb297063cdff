"""Finds the albedo that a fit should keep: the albedo of the samples that the fit uses."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.materials.measured import Measured
from brdfkit.regression.light import Light

# A fit leaves out samples beyond this angle to the normal [degrees] by default. They still show how
# values go on towards the horizon; a fit with a smaller angle does not trust them.
DEFAULT_MAX_ANGLE = 80.0


def light_of_data(data: Measured, weights: ArrayLike | None, max_angle: float) -> Light:
    """Return the `Light` of those samples of a `Measured` that a fit uses.

    Parameters
    ----------
    data : Measured
        The material, in the channels of the fit.
    weights : array_like, optional
        The user's weights of the samples; samples with weight 0 do not count.
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
    if weights is None and max_angle >= DEFAULT_MAX_ANGLE:
        light = Light.of(data.albedo, data.anisotropic)
    elif data.has_lookup:  # it interpolates by itself, from all its samples
        light = Light.of(data.albedo, data.anisotropic)
        light = replace(light, known=light.known & (weights is None))
    else:
        light = Light.of(_select(data, weights, max_angle).albedo, data.anisotropic)
    return replace(light, known=light.known & (np.array(light.theta_i) < max_angle))


def _select(data: Measured, weights: ArrayLike | None, max_angle: float) -> Measured:
    """Return the samples of a `Measured` below `max_angle` whose weight is above 0.

    From `DEFAULT_MAX_ANGLE` on, all angles count.
    """
    samples = data.samples
    good = samples.valid if max_angle >= DEFAULT_MAX_ANGLE else samples.within(max_angle)
    if weights is not None:
        good = good & (np.ravel(weights) > 0)
    if data.is_table:
        values = data.table.values
        values_in_use = np.where(good.reshape(values.shape[:-1])[..., None], values, np.nan)
        return Measured.from_table(
            values_in_use,
            phi_d_period=data.table.phi_d_period,
            channels=data.channels,
            name=data.name,
        )
    part = samples.at(good)
    return Measured.from_samples(
        part.wi,
        part.wo,
        part.values,
        anisotropic=data.anisotropic,
        channels=data.channels,
        name=data.name,
    )
