"""What a model misses that is the same at every azimuth, of a material that is not."""

import math

import numpy as np

from brdfkit.core.geometry.directions import rotate_z
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import differentiate
from brdfkit.core.jit.threads import in_turn
from brdfkit.regression import Picture

# Direction pairs and turns of the surface, by which azimuths are compared
PAIRS, TURNS = 2_000, 8


def is_isotropic(model, wi, wo):
    """Whether a model with values stays the same as the surface turns, at pairs (n, 3)."""
    values = model.eval(wi, wo)
    turned = [model.eval(rotate_z(wi, angle), rotate_z(wo, angle)) for angle in (0.7, 1.9)]
    apart = max(abs(other - values).max() for other in turned)
    return bool(apart <= 1e-9 * abs(values).max())


def note_on_azimuth(data, samples, loss, fitted):
    """The note on the fit of a model to `Samples` of an anisotropic `Measured`, or None.

    Of a table, or where the format has values between its samples, it tells the least error of any
    isotropic model: the spread over the azimuths.
    """
    rows = np.linspace(0, len(samples.wi) - 1, min(PAIRS, len(samples.wi))).astype(int)
    part = samples.at(rows)
    if not is_isotropic(fitted, part.wi, part.wo):
        return None
    note = "the material changes as the surface turns, and the model as fitted does not"
    if isinstance(loss, Picture) or not (data.is_table or data.has_lookup):
        return note  # pixels have no error at one azimuth
    least = _least_error(data if fitted.wavelengths else data.rgb, part, loss)
    return f"{note}: no isotropic one has an error below about {least:.2g}"


@in_turn
def _least_error(data, part, loss):
    """The least E of any isotropic model at `Samples` and their turns.

    At each pair it is the best single value for all azimuths, one step of Gauss and Newton from
    their mean: exact where the difference is linear in the model's value, or one of functions of
    the two values.
    """
    angles = np.arange(TURNS) * 2 * np.pi / TURNS
    measured = np.stack([data.eval(rotate_z(part.wi, a), rotate_z(part.wo, a)) for a in angles])
    cosines = [double_precision.to_array(np.tile(w[:, 2], TURNS)) for w in (part.wi, part.wo)]
    squares = 0.0
    for own in np.moveaxis(measured, 2, 0):
        given = double_precision.to_array(own.ravel())

        def difference(value, given=given):
            return loss.difference(value, given, *cosines)

        start = double_precision.to_array(np.tile(own.mean(axis=0), TURNS))
        d, slope = (np.array(x).reshape(own.shape) for x in differentiate(difference, start))
        gain = (d * slope).sum(axis=0) ** 2 / np.maximum((slope**2).sum(axis=0), 1e-300)
        squares = squares + ((d**2).sum(axis=0) - gain) / TURNS
    return math.sqrt(loss.importance(part) @ squares)
