"""Pictures that explain shadow maps: the size of their texels on the scene, and their depths."""

import zlib
from dataclasses import dataclass
from math import ceil, sqrt
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.maps.light_shadow import LightShadow, ShadowMap
from brdfkit.shadows.maps.placement import Placement

CHECKS = 32  # number of squares of the checkerboard along a side of a shadow map
SIDE = 256  # side of the picture that shows the depths in all maps [pixels]
OUTSIDE = 255  # map index of pixels that no map covers
DARK_SQUARE = 0.45  # brightness of the dark squares of the checkerboard, relative to the others


@dataclass(frozen=True)
class CompressedArray:
    """A NumPy array, compressed in memory.

    shape : the shape of the array.
    dtype : its type as NumPy's text, such as "<f4".
    data : its compressed bytes.
    """

    shape: tuple[int, ...]
    dtype: str
    data: bytes

    @classmethod
    def from_array(cls, array: AnyArray) -> "CompressedArray":
        """Compress an array without loss.

        The bytes are reordered first, as this compresses better: the first byte of every value,
        then the second byte of every value, and so on.
        """
        bytes_apart = np.ascontiguousarray(array).reshape(-1, 1).view(np.uint8).T
        return cls(array.shape, array.dtype.str, zlib.compress(bytes_apart.tobytes()))

    @property
    def array(self) -> AnyArray:
        """The array, decompressed."""
        dtype = np.dtype(self.dtype)
        rows = np.frombuffer(zlib.decompress(self.data), np.uint8).reshape(dtype.itemsize, -1)
        return np.ascontiguousarray(rows.T).view(dtype).reshape(self.shape)


@dataclass(frozen=True)
class MapPictures:
    """Pictures of the shadow maps of one projection and partition, kept compressed.

    The properties `shade`, `part` and `depths` return the pictures.

    checker, parts, view : these pictures, compressed, in the same order.
    """

    checker: CompressedArray
    parts: CompressedArray
    view: CompressedArray

    @classmethod
    def from_view(cls, view: LitView, placement: Placement, **settings: Any) -> "MapPictures":
        """Make shadow maps for a view, with the `settings` of `LightShadow`, and draw them."""
        shadow = LightShadow(view.scene, placement, **settings)
        shade, part = draw_texel_checkerboard(shadow, view)
        depths = arrange_squares([scale_depths(each) for each in shadow.maps])
        return cls(*map(CompressedArray.from_array, (shade, part, depths)))

    @property
    def shade(self) -> FloatArray:
        """The brightness (height, width), 0 to 1, of the scene under a checkerboard of texels."""
        return self.checker.array / np.float32(255)

    @property
    def part(self) -> IntArray:
        """The index (height, width) of the map that covers each pixel, or else `OUTSIDE`."""
        return self.parts.array

    @property
    def depths(self) -> FloatArray:
        """One picture (SIDE, SIDE) of the depths in all maps: 0 near, 1 far, NaN without a surface.

        Several maps are arranged in rows, the first at the upper left.
        """
        return self.view.array


def draw_texel_checkerboard(shadow: LightShadow, view: LitView) -> tuple[IntArray, IntArray]:
    """Return the scene's brightness under a checkerboard, 0 to 255, and each pixel's map index.

    The checkerboard is projected onto the scene like a shadow map, so its squares show where texels
    are large. Both pictures are (height, width); the index is `OUTSIDE` where no map reaches.
    """
    valid = np.array(view.si.is_valid())
    shade = valid * (0.3 + 0.7 * np.abs(np.array(view.si.wi.z)))
    chosen, part = np.array(shadow.find_part(view.si.p)), np.full(len(valid), OUTSIDE)
    for index, its_map in enumerate(shadow.maps):
        x, y, _ = (np.array(component) for component in its_map.projection.project(*view.si.p))
        inside = valid & (chosen == index) & (np.abs(x) <= 1) & (np.abs(y) <= 1)
        columns, rows = (np.floor((place[inside] + 1) / 2 * CHECKS) for place in (x, y))
        shade[inside] *= np.where((columns + rows) % 2, DARK_SQUARE, 1)
        part[inside] = index
    return (
        np.round(255 * shade).astype(np.uint8).reshape(view.size),
        part.astype(np.uint8).reshape(view.size),
    )


def scale_depths(its_map: ShadowMap) -> FloatArray:
    """Return a map's depths for a picture: 0 at the nearest surface, 1 at the farthest.

    The percentiles 1 and 99 count as nearest and farthest. y points up; NaN means no surface.
    """
    depths: FloatArray = np.array(its_map.depths)[::-1]
    known = depths[np.isfinite(depths)]
    if not known.size:
        return np.full_like(depths, np.nan)
    near, far = np.percentile(known, [1, 99])
    shares = np.clip((depths - near) / max(far - near, 1e-12), 0, 1)
    return np.where(np.isfinite(depths), shares, np.nan)


def arrange_squares(squares: list[FloatArray]) -> FloatArray:
    """Resize square pictures, and arrange them in rows in one square picture (SIDE, SIDE)."""
    columns = ceil(sqrt(len(squares)))
    side = SIDE // columns
    arranged = np.full((SIDE, SIDE), np.nan, np.float16)
    for index, square in enumerate(squares):
        row, column = divmod(index, columns)
        nearest = (2 * np.arange(side) + 1) * len(square) // (2 * side)
        place = slice(row * side, (row + 1) * side), slice(column * side, (column + 1) * side)
        arranged[place] = square[np.ix_(nearest, nearest)]
    return arranged
