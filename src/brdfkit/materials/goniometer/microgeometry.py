"""Makes microgeometry: small periodic height fields, whose BRDF the virtual goniometer measures.

Lengths are in cells of the grid of heights. The mean height is 0, and z points up. Each cell
consists of two triangles.

[Beckmann & Spizzichino 1963] describe the Gaussian surface. Its slopes have the distribution of
Beckmann's microfacets with alpha = √2·slope.
"""

import inspect
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import no_such_error

SIZE = 512  # number of grid cells along a side of a height field


@dataclass(frozen=True, eq=False)
class HeightField:
    """A square tile of heights, which repeats without end in x and y.

    `heights`: height of the point x = i, y = j at [i, j], (n, n); `isotropic`: whether a
    measurement averages over the azimuth of the tile; `parts`: names of the materials that the
    surface is made of; `part`: index in `parts` of each cell's material, (n, n), or None where
    there is only one.

    >>> HeightField(np.zeros((8, 8))).heights.shape
    (8, 8)
    """

    heights: FloatArray
    isotropic: bool = True
    parts: tuple[str, ...] = ("facets",)
    part: IntArray | None = field(default=None, repr=False)

    def vertices(self) -> FloatArray:
        """Return the points ((n + 3)², 3) of the tile, whose centre is x = y = 0.

        They include one more cell of its repetition on each side.
        """
        n = len(self.heights)
        i, j = np.mgrid[-1 : n + 2, -1 : n + 2]
        return np.stack([i - n / 2, j - n / 2, self.heights[i % n, j % n]], axis=-1).reshape(-1, 3)

    def faces(self, part: int) -> IntArray:
        """Return the triangles (m, 3) of the material number `part`, as indices of `vertices`."""
        n = len(self.heights)
        i, j = np.mgrid[: n + 2, : n + 2]
        if self.part is not None:
            i, j = (x[self.part[(i - 1) % n, (j - 1) % n] == part] for x in (i, j))
        a, along_x, along_y = (i * (n + 3) + j).ravel(), n + 3, 1
        b = a + along_x + along_y
        return np.concatenate(
            [np.stack([a, a + along_x, b], -1), np.stack([a, b, a + along_y], -1)]
        )


def gaussian(slope: float = 0.3, seed: int = 0) -> HeightField:
    """Make an isotropic Gaussian surface, like sandblasted metal or plaster.

    `slope` is its root-mean-square slope along any axis, above 0, at most 2.

    >>> gaussian(slope=0.2).isotropic
    True
    """
    return HeightField(_make_gaussian_heights(slope, 8, 8, seed))


def brushed(slope: float = 0.3, stretch: float = 8, seed: int = 0) -> HeightField:
    """Make an anisotropic Gaussian surface with grooves along x, like brushed metal.

    `slope` is the root-mean-square slope across the grooves, above 0, at most 2. `stretch` is the
    length of a groove over its width, 1 to 32: along the grooves the slope is slope / stretch.

    >>> brushed(stretch=4).isotropic
    False
    """
    to_number("stretch", stretch, 1, 32)
    return HeightField(_make_gaussian_heights(slope, 5 * stretch, 5, seed), isotropic=False)


def woven(slope: float = 0.3, thickness: float = 0.5, seed: int = 0) -> HeightField:
    """Make a woven cloth in plain weave: warp yarns along y and weft yarns along x.

    A Gaussian surface roughens the yarns like fibres along them. `slope` is its root-mean-square
    slope across the fibres, above 0, at most 2. `thickness` is the thickness of a yarn over its
    width, 0.1 to 1.

    >>> woven().parts
    ('warp', 'weft')
    """
    to_number("thickness", thickness, 0.1, 1)
    yarns = 8  # number of yarns side by side in a tile; an odd number would not repeat seamlessly
    width = SIZE / yarns
    half = thickness * width / 2
    # Coordinate of the grid points along x, and likewise along y, in units of a yarn's width
    s = (np.arange(SIZE) + 0.5) / width
    # The height of a yarn's round upper side, and that of its path over and under the other yarns
    crown = half * np.sqrt(1 - (2 * (s % 1) - 1) ** 2)
    over_under = half * np.outer((-1) ** s.astype(int), np.cos(np.pi * (s - 0.5)))
    # Add the roughness of fibres along each yarn, and take the higher yarn at each point
    warp = crown[:, None] + over_under + _make_gaussian_heights(slope, 4, 24, seed)
    weft = crown[None, :] - over_under.T + _make_gaussian_heights(slope, 24, 4, seed + 1)
    heights = np.maximum(warp, weft)
    return HeightField(heights - heights.mean(), False, ("warp", "weft"), (weft > warp).astype(int))


GEOMETRIES = {function.__name__: function for function in (gaussian, brushed, woven)}


def make_height_field(name: str, **parameters: float) -> HeightField:
    """Make the height field of a kind of surface, "gaussian", "brushed" or "woven".

    `parameters` are the arguments of the function of that name. Raises `BrdfkitError` for an
    unknown name or parameter.

    >>> make_height_field("gaussian", slope=0.2).heights.std() > 0
    True
    """
    if name not in GEOMETRIES:
        raise no_such_error("geometry", name, GEOMETRIES)
    known = inspect.signature(GEOMETRIES[name]).parameters
    for parameter in parameters.keys() - known.keys():
        raise no_such_error("parameter", parameter, known, where=name)
    geometry: Any = GEOMETRIES[name]
    return geometry(**parameters)


def _make_gaussian_heights(slope: float, length_x: float, length_y: float, seed: int) -> FloatArray:
    """Make the heights (n, n) of a periodic Gaussian surface.

    Their autocorrelation is exp(-(x/length_x)² - (y/length_y)²). The triangles have exactly the
    root-mean-square `slope` along the axis of the shorter length.
    """
    to_number("slope", slope, above=0, most=2)
    to_whole_number("seed", seed, 0)
    # Filter white noise in the frequency domain, to give the heights a Gaussian autocorrelation
    noise = np.fft.fft2(np.random.default_rng(seed).standard_normal((SIZE, SIZE)))
    k = 2 * np.pi * np.fft.fftfreq(SIZE)
    x, y = np.meshgrid(length_x * k, length_y * k, indexing="ij")
    heights = np.fft.ifft2(noise * np.exp(-(x * x + y * y) / 8)).real
    heights -= heights.mean()

    # The slope is asked for along the axis with the shorter correlation length. A slope along the
    # other axis is smaller by the ratio of the lengths, so it is multiplied by it; then the mean
    # square of both axes' slopes gives the factor that scales the heights
    shorter = min(length_x, length_y)
    squares = [
        np.mean((length / shorter * (np.roll(heights, -1, axis) - heights)) ** 2)
        for axis, length in enumerate((length_x, length_y))
    ]
    return heights * slope / np.sqrt(np.mean(squares))
