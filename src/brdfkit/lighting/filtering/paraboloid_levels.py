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

from brdfkit.core.array_types import AnyArray, FloatArray, JitFloat
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
    along = BORDER * ((np.arange(side) + 0.5) * 2 / side - 1)
    s, t = np.meshgrid(along, along)
    return np.stack([np.stack(from_disc(s, t, sign), axis=-1) for sign in (1, -1)])


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


def convolve_with_lobes(picture: FloatArray, side: float) -> list[FloatArray]:
    """Convolve an environment map with ever wider lobes, and return a level for each of them.

    `picture` (height, 2 height, channels) is by latitude and longitude. The concentration of the
    lobes begins with `sharpest_kappa(side)`, and falls by the factor `STEP` per level. A level has
    the shape (hemispheres, texels, texels, channels). The last few results are kept, since most
    previews have the same light.
    """
    pixels = np.asarray(picture, np.float32).tobytes()
    return list(_convolve_with_lobes(pixels, picture.shape, side))


@lru_cache(CACHED_PICTURES)
def _convolve_with_lobes(pixels: bytes, shape: tuple[int, ...], side: float) -> list[FloatArray]:
    """Convolve a picture, given as bytes of float32 so that calls can be cached, with lobes.

    The levels are float32 as well: they are looked up in single precision.
    """
    picture: FloatArray = np.frombuffer(pixels, np.float32).reshape(shape).astype(float)
    kappa, levels = sharpest_kappa(side), []
    while kappa > SMALLEST_KAPPA:
        while len(picture) > ROWS * max(side, SMALLEST_SIDE):
            picture = halve_resolution(picture)
        sharper = (1 + BLUR) * kappa

        def evaluate_lobe(cos: AnyArray, kappa: float = sharper) -> AnyArray:
            return np.exp(log_density(cos, kappa))

        filtered = convolve_on_sphere(
            picture, evaluate_lobe, math.acos(max(1 - CUT_OFF / kappa, -1))
        )
        discs = resample_to_discs(filtered, max(round(side), SMALLEST_SIDE))
        levels.append(discs.astype(np.float32))
        kappa, side = kappa / STEP, side / math.sqrt(STEP)
    return levels


def resample_to_discs(picture: FloatArray, side: int) -> FloatArray:
    """Resample a `picture` by latitude and longitude to dual-paraboloid pictures.

    The result has the shape (2, side, side, channels), with z ≥ 0 first, then z < 0.
    """
    from scipy.ndimage import map_coordinates

    height, width = picture.shape[:2]
    x, y, z = np.moveaxis(texel_directions(side), -1, 0)
    around = 8  # pixels added beyond each edge; beyond a pole they show the opposite azimuth
    half = np.roll(picture, width // 2, axis=1)
    tall = np.concatenate([half[:around][::-1], picture, half[-around:][::-1]])
    wide = np.pad(tall, ((0, 0), (around, around), (0, 0)), mode="wrap")
    row = np.arccos(np.clip(z, -1, 1)) / np.pi * height - 0.5 + around
    column = np.arctan2(y, x) % (2 * np.pi) / (2 * np.pi) * width - 0.5 + around
    bands = [map_coordinates(band, [row, column]) for band in np.moveaxis(wide, -1, 0)]
    return np.stack(bands, axis=-1).clip(0)
