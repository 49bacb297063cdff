"""What maps show under any light, by the model's formula: direct light alone."""

import numpy as np

from brdfkit.inverse.photographs.capture.observations import Observations, directions
from brdfkit.inverse.photographs.maps.maps import numbers_of
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS


def predict(svbrdf, points, to_light, irradiance, eye):
    """Radiances (k, height, width, 3) of an `Svbrdf`'s texels at `points` (n, 3) [m], by unit
    vectors to lights and irradiances (k, n, 3), seen from `eye` (3,)."""
    to_camera = directions(eye, points)
    nothing = np.zeros_like(to_light)
    seen = Observations(
        nothing, nothing, to_light, irradiance, np.broadcast_to(to_camera, to_light.shape), (1, 1)
    )
    numbers, x = numbers_of(svbrdf)
    return radiances(numbers, x, seen).reshape(-1, *svbrdf.shape, CHANNELS)


def radiances(numbers, x, seen):
    """Radiances (k, n, 3) of rows `x` (n, count), seen as `Observations`."""
    value, _ = numbers.radiances(x, seen, slopes=False)
    weights = x[:, : numbers.shapes.start].reshape(len(x), -1, CHANNELS)
    shown = sum(lobe[..., None] * weights[:, k] for k, lobe in enumerate(value))
    return shown * seen.irradiance
