"""The levels of a filtered environment map, each a pair of dual-paraboloid pictures.

There are two ways to make the levels. `make_mips` makes mip levels, in which a texel is the mean of
four texels of the level before. `convolve_with_lobes` convolves the map with von Mises-Fisher lobes
of known concentrations κ, so that a look-up has exactly the width of a lobe; there are four levels
for each halving of the size. The picture of a hemisphere is a square around a disc. It is larger
than the disc by the factor `BORDER`, and its border shows the rim of the other hemisphere, so that
a look-up can interpolate at the disc's rim.

[Ergun 2015, eqs. 8.8-8.10, whose b is `BORDER`]
"""

import math
from functools import lru_cache

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray, JitFloat
from brdfkit.core.geometry.dual_paraboloid import from_disc, solid_angle_per_area
from brdfkit.lighting.filtering.sphere_filter import convolve_on_sphere, halve_resolution
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import log_density

BORDER = 1.2  # width of a hemisphere's picture relative to the diameter of its disc
# Smallest number of texels along a side of a level; with fewer, the border around the disc would be
# too narrow to interpolate in
SMALLEST_SIDE = 16
# Texels per standard deviation 1/√κ of the sharpest lobe, in the middle of a disc, where texels
# cover the largest angles
TEXELS = 2.0
# Ratio of the concentrations κ of two successive levels, so small that a lobe between two levels is
# nearly their mean
STEP = 2**0.5
# A map that is convolved has at most this many rows per texel along a side of the level; larger
# maps are first halved to save time
ROWS = 1.7
SMALLEST_KAPPA = 0.5  # concentration κ of the widest lobe, nearly uniform; it replaces wider lobes
# Lobes are cut off where they fall to e^-12 of their peak; a share of e^-12 of the integral lies
# beyond
CUT_OFF = 12.0
# Share by which the interpolation between texels widens a lobe's variance, so the lobes that are
# convolved are sharper by it
BLUR = 0.03
COVERAGE = 0.5  # share of a lobe that a texel of its mip level covers, a in [Ergun 2015, eq. 8.9]
# Pictures whose levels are kept for the next call; with a level of 512 texels, the default of
# `filtered_environment`, the levels take 21 MB, and the picture itself 6 MB
CACHED_PICTURES = 2


def texel_directions(side: int) -> FloatArray:
    """Return the directions (2, side, side, 3) of the middles of a level's texels.

    The first picture is the hemisphere z ≥ 0, the second one z < 0.
    """
    s, t = place_texels(side)
    return np.stack([np.stack(from_disc(s, t, sign), axis=-1) for sign in (1, -1)])


def place_texels(side: int) -> tuple[FloatArray, FloatArray]:
    """Return the coordinates s and t (side, side) of the middles of a hemisphere's texels.

    The disc has the radius 1.
    """
    along = BORDER * ((np.arange(side) + 0.5) * 2 / side - 1)
    s, t = np.meshgrid(along, along)
    return s, t


def make_mips(base: FloatArray) -> list[FloatArray]:
    """Return the mip levels of the map `base` (2, side, side, channels), by means over 2×2 texels.

    The first axis is that of the two hemispheres.

    >>> [level.shape[1] for level in make_mips(np.ones((2, 64, 64, 3)))]
    [64, 32, 16]
    """
    levels = [base]
    while levels[-1].shape[1] >= 2 * SMALLEST_SIDE:
        side = levels[-1].shape[1] // 2
        levels.append(levels[-1].reshape(2, side, 2, side, 2, -1).mean(axis=(2, 4)))
    return levels


def mip_level(kappa: JitFloat, z: JitFloat, side: int, coverage: float = COVERAGE) -> JitFloat:
    """Return the fractional mip level whose texels are as large as a lobe [Ergun 2015, eq. 8.9].

    The lobe's size is that of the spherical cap with the share `coverage` of its energy. `kappa` is
    its concentration, `z` the z component of its axis, and `side` the size of the finest level
    [texels].

    >>> round(mip_level(100.0, 0.5, 512, coverage=0.9), 5)
    5.75745
    """
    return 0.5 * dr.log2(cap_solid_angle(kappa, coverage) / texel_solid_angle(z, side))


def cap_solid_angle(kappa: JitFloat, coverage: float) -> JitFloat:
    """Return the solid angle [sr] of the spherical cap with the share `coverage` of a lobe.

    The cap lies about the axis of the von Mises-Fisher lobe with the concentration `kappa`.
    """
    return -2 * math.pi * math.log(1 - coverage) / kappa


def texel_solid_angle(z: JitFloat, side: int) -> JitFloat:
    """Return the solid angle [sr] of a texel at directions with the z component `z`.

    The picture has `side` texels along a side. [Ergun 2015, eqs. 8.8, 8.10]
    """
    return 4 * BORDER**2 * solid_angle_per_area(z) / side**2


def sharpest_kappa(side: float) -> float:
    """Return the concentration κ of the sharpest lobe that a level of `side` texels resolves."""
    return (side / (4 * BORDER * TEXELS)) ** 2


def convolve_with_lobes(
    picture: FloatArray, side: float, sharpest: float = math.inf
) -> list[FloatArray]:
    """Convolve an environment map with ever wider lobes, and return a level for each of them.

    `picture` (height, 2 height, channels) is by latitude and longitude. The concentration of the
    lobes begins with `sharpest_kappa(side)`, and falls by the factor `STEP` per level. A level has
    the shape (hemispheres, texels, texels, channels). Levels that no look-up of a lobe needs whose
    concentration is at most `sharpest` are 0. The last few results are kept, since most previews
    have the same light.
    """
    pixels = np.asarray(picture, np.float32).tobytes()
    return list(_convolve_with_lobes(pixels, picture.shape, side, sharpest))


@lru_cache(CACHED_PICTURES)
def _convolve_with_lobes(
    pixels: bytes, shape: tuple[int, ...], side: float, sharpest: float
) -> list[FloatArray]:
    """Convolve a picture, given as bytes of float32 so that calls can be cached, with lobes.

    The levels are float32 as well: they are looked up in single precision.
    """
    picture: FloatArray = np.frombuffer(pixels, np.float32).reshape(shape).astype(float)
    kappa, levels = sharpest_kappa(side), []
    while kappa > SMALLEST_KAPPA:
        texels = max(round(side), SMALLEST_SIDE)
        if kappa > 1.01 * STEP * sharpest:  # all look-ups lie beyond the next level
            levels.append(np.zeros((2, texels, texels, shape[2]), np.float32))
            kappa, side = kappa / STEP, side / math.sqrt(STEP)
            continue
        while len(picture) > ROWS * max(side, SMALLEST_SIDE):
            picture = halve_resolution(picture)
        sharper = (1 + BLUR) * kappa

        def evaluate_lobe(cos: AnyArray, kappa: float = sharper) -> AnyArray:
            return np.exp(log_density(cos, kappa))

        filtered = convolve_on_sphere(
            picture, evaluate_lobe, math.acos(max(1 - CUT_OFF / kappa, -1))
        )
        levels.append(resample_to_discs(filtered, texels))
        kappa, side = kappa / STEP, side / math.sqrt(STEP)
    return levels


def resample_to_discs(picture: FloatArray, side: int) -> AnyArray:
    """Resample a smooth `picture` by latitude and longitude to dual-paraboloid pictures.

    The result has the shape (2, side, side, channels), with z ≥ 0 first, then z < 0. It is 0 in the
    corners, which no look-up reads.
    """
    height, width, channels = picture.shape
    # The hemisphere z < 0 is the upper hemisphere of the picture upside down
    single = picture.astype(np.float32)
    both = np.concatenate([single, single[::-1]], axis=-1)
    around = 2  # pixels added beyond each edge; beyond a pole they show the opposite azimuth
    half = np.roll(both, width // 2, axis=1)
    tall = np.concatenate([half[:around][::-1], both, half[-around:][::-1]])
    wide = np.pad(tall, ((0, 0), (around, around), (0, 0)), mode="wrap")
    s, t = place_texels(side)
    # A look-up at the disc's rim reads texels whose middles are less than a diagonal outside
    read = np.hypot(s, t) < 1 + 2 * math.sqrt(2) * BORDER / side
    x, y, z = from_disc(s[read], t[read], 1)
    row = np.arccos(np.clip(z, -1, 1)) / np.pi * height - 0.5 + around
    column = np.arctan2(y, x) % (2 * np.pi) / (2 * np.pi) * width - 0.5 + around
    discs = np.zeros((side, side, 2 * channels), np.float32)
    discs[read] = _interpolate_cubically(wide, row, column).clip(0)
    return np.moveaxis(discs.reshape(side, side, 2, channels), 2, 0)


def _interpolate_cubically(picture: AnyArray, row: FloatArray, column: FloatArray) -> AnyArray:
    """Interpolate a `picture` (height, width, channels) at places (n,) by Catmull-Rom splines.

    There are at least two pixels around each place in every direction.
    """
    width, channels = picture.shape[1:]
    pixels = picture.reshape(-1, channels)
    (top, row_weights), (left, column_weights) = map(_weigh_four_pixels, (row, column))
    total = np.zeros((len(row), channels), picture.dtype)
    for i, along_rows in enumerate(row_weights):
        for j, along_columns in enumerate(column_weights):
            place = (top + i) * width + left + j
            total += (along_rows * along_columns)[:, None] * pixels.take(place, axis=0)
    return total


def _weigh_four_pixels(place: FloatArray) -> tuple[IntArray, list[AnyArray]]:
    """Return the first of the four pixels around each `place` (n,), and the weights of the four."""
    second = np.floor(place)
    t = (place - second).astype(np.float32)
    weights = [
        t * (t * (2 - t) - 1) / 2,
        t * t * (1.5 * t - 2.5) + 1,
        t * (t * (2 - 1.5 * t) + 0.5),
        t * t * (t - 1) / 2,
    ]
    return second.astype(int) - 1, weights
