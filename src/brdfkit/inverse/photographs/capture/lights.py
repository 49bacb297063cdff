"""Defines `Lights`, the lights of the photographs of an object: distant ones, or lamps nearby."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from brdfkit.core.arguments import to_array, wrong_value_error
from brdfkit.core.array_types import ArrayLike, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Lights:
    """The lights of k photographs of an object, one for each photograph.

    x points to the right in a photograph, y up, and z towards the camera. Lamps have positions,
    whose origin is the middle of the object; distant lights have none. A lamp with an exponent µ
    shines around its axis with the radiant intensity I cos^µ.

    Attributes
    ----------
    directions : ndarray, shape (lights, 3)
        Unit vectors from the middle of the object to the lights.
    intensities : ndarray, shape (lights, 3)
        Irradiances [W/m²] that distant lights cause on a surface facing them, or radiant
        intensities [W/sr] of lamps along their axes, in red, green and blue.
    positions : ndarray, shape (lights, 3), optional
        Positions of lamps [m]; None for distant lights.
    axes : ndarray, shape (lights, 3), optional
        Unit vectors along which the lamps shine; None for lamps that shine equally everywhere.
    exponents : ndarray, shape (lights,), optional
        The exponents µ, at least 0.
    """

    directions: FloatArray
    intensities: FloatArray
    positions: FloatArray | None = None
    axes: FloatArray | None = None
    exponents: FloatArray | None = None

    def __len__(self) -> int:
        """Return the number of lights."""
        return len(self.directions)

    def select(self, lights: IntArray) -> Lights:
        """Return the lights with the given indices."""
        chosen = {
            field.name: values[lights]
            for field in fields(self)
            if (values := getattr(self, field.name)) is not None
        }
        return replace(self, **chosen)

    def illuminate(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return unit vectors from points to the lights, and irradiances of surfaces facing them.

        `points` (n, 3) [m] are only needed for lamps. Both results have the shape (lights, n, 3).
        """
        shape = len(self), len(points), 3
        if self.positions is None:
            return (
                np.broadcast_to(self.directions[:, None], shape),
                np.broadcast_to(self.intensities[:, None], shape),
            )
        away = self.positions[:, None] - points
        square = (away**2).sum(axis=2, keepdims=True)
        to_light = away / np.sqrt(square)
        irradiance = self.intensities[:, None] / square
        if self.axes is not None and self.exponents is not None:
            cosine = np.maximum(-(to_light * self.axes[:, None]).sum(axis=2), 0)
            irradiance = irradiance * (cosine ** self.exponents[:, None])[..., None]
        return to_light, irradiance


def to_strength(what: str, value: ArrayLike) -> FloatArray:
    """Return a user's strength of one light, a number or three, as an array (1, 3).

    `what` names the argument in errors. Raises `BrdfkitError` unless the numbers are 0 or above.
    """
    strength = to_array(what, value)
    if (
        strength.shape not in ((), (1,), (3,))
        or not (np.isfinite(strength) & (strength >= 0)).all()
    ):
        raise wrong_value_error(what, value, "a number, or three, 0 or above")
    return np.broadcast_to(strength, (1, 3))
