"""Defines `ObjectCapture`, photographs of an object by one still camera under known lights."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.inverse.photographs.capture.lights import Lights


@dataclass(frozen=True, eq=False)
class ObjectCapture:
    """Photographs of an object by a camera that stands still, each under one light.

    x points to the right in a photograph, y up, and z towards the camera. Only the n pixels of the
    object are kept, row by row from the upper left.

    Attributes
    ----------
    name : str
        Name of the object.
    values : ndarray of float32, shape (lights, n, 3)
        Linear values of the object's pixels: radiance [W/(m² sr)], or numbers in proportion to it
        by the same factor in all photographs.
    mask : ndarray of bool, shape (height, width)
        Which pixels of a photograph show the object; n of them are True.
    lights : Lights
        The light of each photograph.
    names : tuple of str
        Names of the photographs.
    lost : ndarray of bool, shape (lights, n, 3), optional
        Which values do not count, because the sensor was saturated or a person marked them.
    normals : ndarray, shape (n, 3), optional
        The true unit normals, where they are known.
    pixel_size : float, optional
        The side of a pixel at the object [m]; needed for lamps, and for a camera nearby.
    distance : float, optional
        The distance of the camera from the object [m]; None for a camera far away.
    notes : tuple of str
        Sentences on what was found while the files were read.
    """

    name: str
    values: FloatArray
    mask: BoolArray
    lights: Lights
    names: tuple[str, ...]
    lost: BoolArray | None = None
    normals: FloatArray | None = None
    pixel_size: float | None = None
    distance: float | None = None
    notes: tuple[str, ...] = ()

    @cached_property
    def points(self) -> FloatArray:
        """The places (n, 3) of the pixels [m], or in pixels without a `pixel_size`, all at z = 0.

        The origin is the middle of the object's bounding box.
        """
        rows, columns = np.nonzero(self.mask)
        x = columns - (columns.min() + columns.max()) / 2
        y = (rows.min() + rows.max()) / 2 - rows
        places: FloatArray = np.stack([x, y, np.zeros_like(x)], axis=1)
        return places * (self.pixel_size or 1.0)

    @cached_property
    def to_camera(self) -> FloatArray:
        """The unit vectors (n, 3) from the pixels to the camera."""
        if self.distance is None:
            return np.broadcast_to(np.array([0.0, 0.0, 1.0]), (int(self.mask.sum()), 3))
        away = np.array([0.0, 0.0, self.distance]) - self.points
        return away / np.linalg.norm(away, axis=1, keepdims=True)

    def select_lights(self, lights: IntArray) -> ObjectCapture:
        """Return the photographs with the given indices."""
        return replace(
            self,
            values=self.values[lights],
            lights=self.lights.select(lights),
            names=tuple(self.names[k] for k in lights),
            lost=None if self.lost is None else self.lost[lights],
        )

    def with_exposures(self, exposures: FloatArray) -> ObjectCapture:
        """Return the photographs with lights that are `exposures` (lights,) times as strong."""
        intensities = self.lights.intensities * exposures[:, None]
        return replace(self, lights=replace(self.lights, intensities=intensities))

    def to_picture(self, values: FloatArray, background: float = 0.0) -> FloatArray:
        """Return a picture (height, width) or (height, width, c) of values of the n pixels."""
        picture = np.full((*self.mask.shape, *values.shape[1:]), background, values.dtype)
        picture[self.mask] = values
        return picture
