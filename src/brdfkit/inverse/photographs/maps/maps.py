"""Converts maps of a sample to the numbers of its texels, and back.

The maps are images of a BRDF model's parameters and of the normal; a texel is a pixel of them. A
search works on an array (texels, numbers) instead. It has a row for each texel, and a column for
each number that `TexelParameters` describes: a parameter's value, its logarithm or the like.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.observations import Observations, find_directions
from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters
from brdfkit.model import Model, labels


@dataclass(frozen=True)
class Maps:
    """The fitted textures of a flat sample: images of a BRDF model's parameters and of the normal.

    model : the model's class.
    fixed : the values of the shape parameters that have no map.
    size : width and height of the sample [m].
    maps : the maps by name, (height, width) or (height, width, 3).
    """

    model: type[Model]
    fixed: dict[str, float]
    size: tuple[float, float]
    maps: dict[str, FloatArray]

    @classmethod
    def from_texel_numbers(
        cls,
        parameters: TexelParameters,
        x: FloatArray,
        shape: tuple[int, int],
        size: tuple[float, float],
    ) -> Maps:
        """Return the maps of `shape` (height, width) for searched numbers `x` (texels, numbers).

        `parameters` describes the columns of `x`; `size` is the sample's width and height [m].
        """
        maps = {}
        for lobe, name in enumerate(parameters.lobes):
            weights = x[:, CHANNELS * lobe : CHANNELS * (lobe + 1)]
            maps[name] = weights.reshape(*shape, CHANNELS)
        shapes = parameters.shapes.to_parameter_values(x[:, parameters.shape_columns].T)
        maps |= {name: values.reshape(shape) for name, values in shapes.items()}
        slant = x[:, parameters.normal_columns]
        z = np.sqrt(np.maximum(1 - (slant**2).sum(axis=1), 1e-4))
        normals = np.concatenate([slant, z[:, None]], axis=1)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        maps["normal"] = normals.reshape(*shape, 3)
        return cls(parameters.model, parameters.fixed, size, maps)


def to_texel_numbers(svbrdf: Any) -> tuple[TexelParameters, FloatArray]:
    """Return the layout of the searched numbers, and an `Svbrdf`'s maps as (texels, numbers)."""
    model, maps = labels.model(svbrdf.model), svbrdf.maps
    weights = model.weights()
    names = tuple(name for name in maps if name not in (*weights, "normal", ANGLE))
    pair = find_width_pair(model, names) if ANGLE in maps else None
    parameters = TexelParameters(model, names, svbrdf.fixed, pair)
    columns = [maps[name].reshape(-1, CHANNELS) for name in weights]
    shapes = [numbers.reshape(-1, 1) for numbers in parameters.shapes.to_search_numbers(maps)]
    normals = maps["normal"].reshape(-1, 3)[:, :2]
    return parameters, np.concatenate([*columns, *shapes, normals], axis=1)


def find_width_pair(model: type[Model], names: Iterable[str]) -> tuple[str, str] | None:
    """Return the shape parameters (u, v) among `names` that are lobe widths along two directions.

    Returns None for an isotropic model.
    """
    return next(
        ((p.follows, name) for name, p in model.parameters.items() if p.follows and name in names),
        None,
    )


def to_error_maps(
    parameters: TexelParameters, errors: FloatArray, x: FloatArray, shape: tuple[int, int]
) -> dict[str, FloatArray]:
    """Return maps (height, width) of standard errors, from those of the searched numbers.

    `errors` belong to the searched numbers `x`; both are (texels, numbers). A colour has the RMS
    error of its channels. The angle of a normal to the true one is within 1.96 of its error
    [radians] with a probability of 95 %.
    """
    by_name = {}
    for lobe, name in enumerate(parameters.lobes):
        own = errors[:, CHANNELS * lobe : CHANNELS * (lobe + 1)]
        by_name[name] = np.sqrt((own**2).mean(axis=1))
    columns = parameters.shape_columns
    by_name |= parameters.shapes.propagate_errors(x[:, columns].T, errors[:, columns].T)
    by_name["normal"] = _compute_angle_errors(errors[:, parameters.normal_columns])
    return {name: error.reshape(shape) for name, error in by_name.items()}


def _compute_angle_errors(errors: FloatArray) -> FloatArray:
    """Return errors (n,) of directions: 95 % of their angles to the true ones are within 1.96.

    `errors` (n, 2) are the standard errors of x and y. The sum of both squared deviations is
    about a multiple of χ² with 1 to 2 degrees of freedom, of the same mean and variance
    [Satterthwaite 1946].
    """
    from scipy.special import gammaincinv

    variances = errors**2
    total = np.maximum(variances.sum(axis=1), 1e-300)
    scale = np.maximum((variances**2).sum(axis=1), 1e-300) / total
    freedom = np.clip(total / scale, 1, 2)
    largest: FloatArray = 2 * scale * gammaincinv(freedom / 2, 0.95)
    return np.sqrt(largest) / 1.96


def predict_radiances(
    svbrdf: Any, points: FloatArray, to_light: FloatArray, irradiance: FloatArray, eye: FloatArray
) -> FloatArray:
    """Return the radiances (k, height, width, 3) of an `Svbrdf` in the direct light of k lamps.

    `points` (n, 3) [m] are the centres of the texels, `to_light` (k, n, 3) unit vectors to the
    lights, `irradiance` (k, n, 3) that of surfaces facing them, and `eye` (3,) [m] the viewer's
    position.
    """
    to_camera = np.broadcast_to(find_directions(eye, points), to_light.shape)
    nothing = np.zeros_like(to_light)
    observed = Observations(nothing, nothing, to_light, irradiance, to_camera, (1, 1))
    parameters, x = to_texel_numbers(svbrdf)
    return parameters.compute_radiances(x, observed).reshape(-1, *svbrdf.shape, CHANNELS)
