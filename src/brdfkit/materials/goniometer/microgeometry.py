"""Microgeometry: small periodic height fields, the specimens of the virtual goniometer.

Lengths are in grid cells; x and y are the axes of the patch, z is up, the mean height is 0.
A surface consists of the triangles between its grid points, two per cell.

The Gaussian surface is that of [Beckmann & Spizzichino 1963]. Its slopes have the distribution of
Beckmann's microfacets with alpha = √2·slope.
"""

import inspect
from dataclasses import dataclass, field

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such

SIZE = 512  # grid cells along a side of the tile


@dataclass(frozen=True, eq=False)
class HeightField:
    """A square tile that repeats in x and y.

    `heights`: (n, n), [i, j] at x = i, y = j; `isotropic`: whether a measurement averages over the
    azimuth of the tile; `parts`: names of the materials that the surface is made of; `part`:
    (n, n), the index in `parts` of each cell, None for one part.

    >>> HeightField(np.zeros((8, 8))).heights.shape
    (8, 8)
    """

    heights: np.ndarray
    isotropic: bool = True
    parts: tuple[str, ...] = ("facets",)
    part: np.ndarray | None = field(default=None, repr=False)

    def vertices(self):
        """The points ((n + 3)², 3) of the tile, centred, with one cell more on every side."""
        n = len(self.heights)
        i, j = np.mgrid[-1 : n + 2, -1 : n + 2]
        return np.stack([i - n / 2, j - n / 2, self.heights[i % n, j % n]], axis=-1).reshape(-1, 3)

    def faces(self, part):
        """The triangles (m, 3) of a part: indices of `vertices`; `part`: an index of `parts`."""
        n = len(self.heights)
        i, j = np.mgrid[: n + 2, : n + 2]
        if self.part is not None:
            i, j = (x[self.part[(i - 1) % n, (j - 1) % n] == part] for x in (i, j))
        a, along_x, along_y = (i * (n + 3) + j).ravel(), n + 3, 1
        b = a + along_x + along_y
        return np.concatenate(
            [np.stack([a, a + along_x, b], -1), np.stack([a, b, a + along_y], -1)]
        )


def gaussian(slope=0.3, seed=0):
    """An isotropic Gaussian surface, as of sandblasted metal or plaster.

    `slope`: its root-mean-square slope along any axis, above 0, at most 2.

    >>> gaussian(slope=0.2).isotropic
    True
    """
    return HeightField(_gaussian(slope, 8, 8, seed))


def brushed(slope=0.3, stretch=8, seed=0):
    """A Gaussian surface of grooves along x, as of brushed metal.

    `slope`: root-mean-square slope across the grooves, above 0, at most 2; along them it is
    slope / stretch; `stretch`: length of a groove over its width, 1 to 32.

    >>> brushed(stretch=4).isotropic
    False
    """
    if not 1 <= stretch <= 32:
        raise BrdfkitError(f"stretch = {stretch:g} is out of bounds; give one from 1 to 32.")
    return HeightField(_gaussian(slope, 5 * stretch, 5, seed), isotropic=False)


def woven(slope=0.3, thickness=0.5, seed=0):
    """A plain weave of warp (along y) and weft (along x): yarns with a grain of fibres.

    `slope`: root-mean-square slope across the fibres, above 0, at most 2; `thickness`: that of a
    yarn over its width, 0.1 to 1.

    >>> woven().parts
    ('warp', 'weft')
    """
    if not 0.1 <= thickness <= 1:
        raise BrdfkitError(f"thickness = {thickness:g} is out of bounds; give one from 0.1 to 1.")
    yarns = 8  # along a side of the tile; even, or the weave would not repeat
    width = SIZE / yarns
    half = thickness * width / 2
    # position across the yarns [widths] at the grid points; it is the same along x and y
    s = (np.arange(SIZE) + 0.5) / width
    # a yarn's round upper side, and its way over and under the yarns that it crosses
    crown = half * np.sqrt(1 - (2 * (s % 1) - 1) ** 2)
    over_under = half * np.outer((-1) ** s.astype(int), np.cos(np.pi * (s - 0.5)))
    # the upper yarn is seen at each place; both have fibres along their length
    warp = crown[:, None] + over_under + _gaussian(slope, 4, 24, seed)
    weft = crown[None, :] - over_under.T + _gaussian(slope, 24, 4, seed + 1)
    heights = np.maximum(warp, weft)
    return HeightField(heights - heights.mean(), False, ("warp", "weft"), (weft > warp).astype(int))


GEOMETRIES = {make.__name__: make for make in (gaussian, brushed, woven)}


def make(name, **parameters):
    """The microgeometry of that name with these parameters.

    >>> make("gaussian", slope=0.2).heights.std() > 0
    True
    """
    if name not in GEOMETRIES:
        raise no_such("geometry", name, GEOMETRIES)
    known = inspect.signature(GEOMETRIES[name]).parameters
    for parameter in parameters.keys() - known.keys():
        raise no_such("parameter", parameter, known, where=name)
    return GEOMETRIES[name](**parameters)


def _gaussian(slope, length_x, length_y, seed):
    """Periodic heights (n, n) with the autocorrelation exp(-(x/length_x)² - (y/length_y)²).

    `slope`: the triangles have exactly this root-mean-square slope along the axis of the shorter
    length.
    """
    if not 0 < slope <= 2:
        raise BrdfkitError(f"slope = {slope:g} is out of bounds; give one above 0, at most 2.")
    if seed < 0:
        raise BrdfkitError(f"The surface's seed {seed} is out of bounds; give at least 0.")
    # white noise, filtered in the frequency domain
    noise = np.fft.fft2(np.random.default_rng(seed).standard_normal((SIZE, SIZE)))
    k = 2 * np.pi * np.fft.fftfreq(SIZE)
    x, y = np.meshgrid(length_x * k, length_y * k, indexing="ij")
    heights = np.fft.ifft2(noise * np.exp(-(x * x + y * y) / 8)).real
    heights -= heights.mean()

    # mean squared slope of the triangles along each axis, scaled to that along the shorter length
    shorter = min(length_x, length_y)
    squares = [
        np.mean((length / shorter * (np.roll(heights, -1, axis) - heights)) ** 2)
        for axis, length in enumerate((length_x, length_y))
    ]
    return heights * slope / np.sqrt(np.mean(squares))
