"""Holds the photographs of a part of an object's pixels, with their lights, as arrays of Dr.Jit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, JitFloat, JitVector
from brdfkit.core.jit.double_precision import Vector, choose_float_type, to_array, to_vector
from brdfkit.core.jit.padding import pad
from brdfkit.inverse.photographs.capture.lights import Lights
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS

PAIRS_PER_TILE = 4_000_000  # pairs of a pixel and a photograph in a tile, to limit the memory


@dataclass(frozen=True)
class Tile:
    """The photographs of n pixels under k lights, as kernels read them.

    values : linear values of the photographs (k · n · 3), nan where they do not count.
    count : n, the number of pixels.
    lights : the lights as columns of numbers, by name.
    exposures : factors (k,) of the irradiances, which the fit estimates.
    points : the places (n,) of the pixels [m].
    to_camera : unit vectors (n,) from the pixels to the camera.
    """

    values: JitFloat
    count: int
    lights: dict[str, list[JitFloat]]
    exposures: JitFloat
    points: JitVector
    to_camera: JitVector

    @classmethod
    def collect(
        cls, capture: ObjectCapture, pixels: AnyArray | slice, exposures: FloatArray
    ) -> Tile:
        """Return the tile of the pixels with the given indices (n,), or in a slice."""
        values = capture.values[:, pixels]
        if capture.lost is not None:
            values = np.where(capture.lost[:, pixels], np.float32(np.nan), values)
        points, to_camera = capture.points[pixels], capture.to_camera[pixels]
        return cls.under_lights(capture.lights, points, to_camera, values, exposures)

    @classmethod
    def under_lights(
        cls,
        lights: Lights,
        points: FloatArray,
        to_camera: FloatArray,
        values: FloatArray | None = None,
        exposures: FloatArray | None = None,
    ) -> Tile:
        """Return a tile of pixels at `points` (n, 3) [m], with or without photographs (k, n, 3).

        `to_camera` (n, 3) are unit vectors to the camera.
        """
        numbers = np.zeros(1, np.float32) if values is None else values
        single: Any = dr.float32_array_t(choose_float_type())
        return cls(
            single(pad(np.ascontiguousarray(numbers, np.float32).ravel())),
            len(points),
            _to_columns(lights),
            to_array(np.ones(len(lights)) if exposures is None else exposures),
            to_vector(points),
            to_vector(to_camera),
        )

    def read_values(self, light: JitFloat) -> tuple[list[JitFloat], JitFloat]:
        """Return the values of each channel in the photograph of a light, and which count."""
        real, whole = choose_float_type(), type(light)
        pixel = dr.arange(whole, self.count)
        place = (light * dr.opaque(whole, self.count) + pixel) * CHANNELS
        values = [
            real(dr.gather(type(self.values), self.values, place + c)) for c in range(CHANNELS)
        ]
        counts = dr.isfinite(values[0] + values[1] + values[2])
        return [dr.select(counts, value, 0) for value in values], counts

    def illuminate(self, light: JitFloat) -> tuple[JitVector, list[JitFloat]]:
        """Return unit vectors to a light and its irradiances in each channel, at all pixels.

        `Lights.illuminate` computes the same in NumPy.
        """
        real = choose_float_type()

        def read(name: str) -> list[JitFloat]:
            """Return the light's numbers of this name."""
            return [dr.gather(real, column, light) for column in self.lights[name]]

        exposure: JitFloat = dr.gather(real, self.exposures, light)
        irradiance = [exposure * value for value in read("intensities")]
        if "positions" not in self.lights:
            return Vector(*read("directions")), irradiance
        away = Vector(*read("positions")) - self.points
        square = away.x * away.x + away.y * away.y + away.z * away.z
        direction = away * dr.rsqrt(square)
        factor = 1 / square
        if "axes" in self.lights:
            axis, (exponent,) = Vector(*read("axes")), read("exponents")
            cosine = -(direction.x * axis.x + direction.y * axis.y + direction.z * axis.z)
            factor = factor * dr.maximum(cosine, 0) ** exponent
        return direction, [value * factor for value in irradiance]


def split_into_tiles(pixels: int, lights: int) -> list[slice]:
    """Return slices of the pixels, each with few enough pairs of a pixel and a photograph."""
    size = max(1, PAIRS_PER_TILE // lights)
    return [slice(first, min(first + size, pixels)) for first in range(0, pixels, size)]


def to_numpy(vector: JitVector) -> FloatArray:
    """Convert a vector of Dr.Jit to an array of NumPy (n, 3)."""
    return np.stack([np.array(vector.x), np.array(vector.y), np.array(vector.z)], axis=1)


def _to_columns(lights: Lights) -> dict[str, list[JitFloat]]:
    """Return the numbers of lights by name, each with an array (k,) for x, y and z or the like."""
    columns = {"directions": lights.directions, "intensities": lights.intensities}
    if lights.positions is not None:
        columns["positions"] = lights.positions
        if lights.axes is not None and lights.exponents is not None:
            columns |= {"axes": lights.axes, "exponents": lights.exponents[:, None]}
    return {name: [to_array(column) for column in values.T] for name, values in columns.items()}
