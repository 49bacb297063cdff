"""Finds the albedos that a fit should keep, from the samples of the material that it uses."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.materials.measured import Measured
from brdfkit.regression.albedo import TargetAlbedo

# By default a fit leaves out samples beyond this angle to the normal [degrees], but their values
# still count in the measured albedo. A fit with a smaller angle ignores them there, too.
DEFAULT_MAX_ANGLE = 80.0


def find_target_albedo(data: Measured, weights: ArrayLike | None, max_angle: float) -> TargetAlbedo:
    """Return the measured albedos that a fit should keep, from the samples that it uses.

    Parameters
    ----------
    data : Measured
        The material, in the channels of the fit.
    weights : array_like, optional
        The user's weights of the samples; samples with weight 0 do not count.
    max_angle : float
        Samples at or beyond this angle to the normal [degrees] are not fitted.

    Returns
    -------
    TargetAlbedo
        The albedos by angle of incidence; angles of `max_angle` and more count as unknown.

    Examples
    --------
    >>> find_target_albedo(paint, None, 80.0).known    # doctest: +SKIP
    array([ True,  True,  True, False])
    """
    if weights is None and max_angle >= DEFAULT_MAX_ANGLE:
        target = TargetAlbedo.from_measured(data.albedo, data.anisotropic)
    elif data.has_lookup:  # its format interpolates all samples, and cannot leave some out
        target = TargetAlbedo.from_measured(data.albedo, data.anisotropic)
        target = replace(target, known=target.known & (weights is None))
    else:
        target = TargetAlbedo.from_measured(
            _select_fitted_samples(data, weights, max_angle).albedo, data.anisotropic
        )
    return replace(target, known=target.known & (np.array(target.theta_i) < max_angle))


def _select_fitted_samples(data: Measured, weights: ArrayLike | None, max_angle: float) -> Measured:
    """Return a `Measured` with only the samples below `max_angle` [degrees] and of weight above 0.

    If `max_angle` is at least `DEFAULT_MAX_ANGLE`, samples at all angles are kept.
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
