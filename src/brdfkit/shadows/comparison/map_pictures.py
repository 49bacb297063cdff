"""Pictures that explain shadow maps: their texels on the scene, and their depths."""

import zlib
from dataclasses import dataclass
from math import ceil, sqrt
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.maps.light_shadow import LightShadow, ShadowMap
from brdfkit.shadows.maps.placement import Placement

CHECKS = 32  # squares of the checkerboard along a side of a map
SIDE = 256  # pixels along a side of the picture of depths
OUTSIDE = 255  # the map index of pixels that no map covers
DARK_SQUARE = 0.45  # the brightness of the dark squares of the checkerboard


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

        The first bytes of all values come first, then the second ones and so on, as this compresses
        better.
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
    """Pictures of the shadow maps of one projection and partition.

    checker, parts, view : the compressed arrays of the properties `shade`, `part` and `depths`.
    """

    checker: CompressedArray
    parts: CompressedArray
    view: CompressedArray

    @classmethod
    def from_view(cls, view: LitView, placement: Placement, **settings: Any) -> "MapPictures":
        """Return the pictures of a view's shadow maps, by keyword arguments of `LightShadow`."""
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
        """The index (height, width) of the map that covers each pixel; `OUTSIDE` without a map."""
        return self.parts.array

    @property
    def depths(self) -> FloatArray:
        """The depths (SIDE, SIDE) in the maps, 0 near to 1 far; NaN without a surface.

        Several maps stand in rows, the first at the upper left.
        """
        return self.view.array


def draw_texel_checkerboard(shadow: LightShadow, view: LitView) -> tuple[IntArray, IntArray]:
    """Return two pictures: the scene's brightness, 0 to 255, under a checkerboard, and map indices.

    The checkerboard is projected like a shadow map, so that its squares show the size of texels.
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
    """Return the depths of a map, y upwards, from 0 at its nearest to 1 at its farthest surface."""
    depths: FloatArray = np.array(its_map.depths)[::-1]
    known = depths[np.isfinite(depths)]
    if not known.size:
        return np.full_like(depths, np.nan)
    near, far = np.percentile(known, [1, 99])
    shares = np.clip((depths - near) / max(far - near, 1e-12), 0, 1)
    return np.where(np.isfinite(depths), shares, np.nan)


def arrange_squares(squares: list[FloatArray]) -> FloatArray:
    """Return square pictures of any size, placed in rows in one square (SIDE, SIDE)."""
    columns = ceil(sqrt(len(squares)))
    side = SIDE // columns
    arranged = np.full((SIDE, SIDE), np.nan, np.float16)
    for index, square in enumerate(squares):
        row, column = divmod(index, columns)
        nearest = (2 * np.arange(side) + 1) * len(square) // (2 * side)
        place = slice(row * side, (row + 1) * side), slice(column * side, (column + 1) * side)
        arranged[place] = square[np.ix_(nearest, nearest)]
    return arranged
