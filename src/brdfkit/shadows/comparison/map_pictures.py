"""Where the texels of shadow maps go, and what the light sees: two pictures of a projection."""

import zlib
from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from brdfkit.shadows.maps.light_shadow import LightShadow


@dataclass(frozen=True)
class Packed:
    """An array by its `shape`, its `kind` (NumPy's dtype) and its compressed bytes, `data`."""

    shape: tuple[int, ...]
    kind: str
    data: bytes

    @classmethod
    def of(cls, array):
        """Of any array; neighbours' bytes of one place stand together, which packs better."""
        bytes_apart = np.ascontiguousarray(array).reshape(-1, 1).view(np.uint8).T
        return cls(array.shape, array.dtype.str, zlib.compress(bytes_apart.tobytes()))

    @property
    def array(self):
        kind = np.dtype(self.kind)
        found = np.frombuffer(zlib.decompress(self.data), np.uint8).reshape(kind.itemsize, -1)
        return np.ascontiguousarray(found.T).view(kind).reshape(self.shape)


CHECKS = 32  # squares of the checker along a side of a map
SIDE = 256  # pixels of the light's view
OUTSIDE = 255  # the part of a pixel that no map covers
DARK = 0.45  # of every other square


@dataclass(frozen=True)
class MapPictures:
    """The maps of a projection in a partition.

    checker, parts, view : what `shade`, `part` and `depths` are.
    """

    checker: Packed
    parts: Packed
    view: Packed

    @classmethod
    def of(cls, seen, placement, **technique):
        """Of what a camera sees, a `Seen`, by keyword arguments of `LightShadow`."""
        shadow = LightShadow(seen.scene, placement, **technique)
        shade, part = checker(shadow, seen)
        depths = side_by_side([seen_by_light(each) for each in shadow.maps])
        return cls(*map(Packed.of, (shade, part, depths)))

    @property
    def shade(self):
        """Brightness (height, width) of the scene, with a checker of squares of its maps' texels,
        in [0, 1]."""
        return self.checker.array / np.float32(255)

    @property
    def part(self):
        """Which map (height, width) a pixel is in; `OUTSIDE` for none."""
        return self.parts.array

    @property
    def depths(self):
        """What the light sees (SIDE, SIDE), 0 near to 1 far; nan where it sees nothing. Several
        maps stand in rows, the first at the upper left."""
        return self.view.array


def checker(shadow, seen):
    """The brightness of the scene, in 255ths, under a checker, and which map each pixel is in."""
    valid = np.array(seen.si.is_valid())
    shade = valid * (0.3 + 0.7 * np.abs(np.array(seen.si.wi.z)))
    chosen, part = np.array(shadow.which(seen.si.p)), np.full(len(valid), OUTSIDE)
    for number, its_map in enumerate(shadow.maps):
        x, y, _ = (np.array(component) for component in its_map.projection.to_map(*seen.si.p))
        inside = valid & (chosen == number) & (np.abs(x) <= 1) & (np.abs(y) <= 1)
        columns, rows = (np.floor((place[inside] + 1) / 2 * CHECKS) for place in (x, y))
        shade[inside] *= np.where((columns + rows) % 2, DARK, 1)
        part[inside] = number
    return (
        np.round(255 * shade).astype(np.uint8).reshape(seen.size),
        part.astype(np.uint8).reshape(seen.size),
    )


def seen_by_light(its_map):
    """The depths of a `ShadowMap`, y upwards, between its nearest and its farthest surface."""
    depths = np.array(its_map.depths)[::-1]
    known = depths[np.isfinite(depths)]
    if not known.size:
        return np.full_like(depths, np.nan)
    near, far = np.percentile(known, [1, 99])
    shares = np.clip((depths - near) / max(far - near, 1e-12), 0, 1)
    return np.where(np.isfinite(depths), shares, np.nan)


def side_by_side(squares):
    """Squares of any size as one (SIDE, SIDE), in rows."""
    columns = ceil(sqrt(len(squares)))
    side = SIDE // columns
    found = np.full((SIDE, SIDE), np.nan, np.float16)
    for number, square in enumerate(squares):
        row, column = divmod(number, columns)
        nearest = (2 * np.arange(side) + 1) * len(square) // (2 * side)
        place = slice(row * side, (row + 1) * side), slice(column * side, (column + 1) * side)
        found[place] = square[np.ix_(nearest, nearest)]
    return found
