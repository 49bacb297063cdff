"""The levels of a filtered map of all directions, each a pair of square dual-paraboloid pictures.

They are either the levels of graphics hardware, in which a texel is the mean of four texels of the
level before, or maps that are convolved with von Mises-Fisher lobes of known concentrations κ, two
for each halving of the size: then a look-up for a κ has exactly that width, and not only about. A
square is larger than its disc by the factor `BORDER`: it contains a margin of the other hemisphere,
so that it can be interpolated at the rim.

[Ergun 2015, eqs. 8.8-8.10, whose b is `BORDER`]
"""

import math
from functools import lru_cache

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, JitFloat
from brdfkit.core.geometry.dual_paraboloid import from_disc, solid_angle
from brdfkit.lighting.filtering.sphere_filter import convolve, halve
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import log_density

BORDER = 1.2
SMALLEST_SIDE = 16  # texels of a level: the border of a smaller one is too narrow to interpolate
TEXELS = 2.0  # per standard deviation κ^-1/2 of a lobe in the middle of a disc, where they are few
STEP = 2**0.5  # ratio of the κ of levels: a lobe between two is nearly the mean of theirs
ROWS = 1.7  # largest number of rows of a picture per texel of the discs that are made of it
SMALLEST_KAPPA = 0.5  # nearly uniform: a wider lobe is looked up as this one
CUT_OFF = 12.0  # where a lobe ends: at e^-12 of its peak, beyond which lies as much of its integral
# Interpolation between texels adds about this share to the variance of a lobe, so that the map is
# convolved with a lobe that much sharper
BLUR = 0.03
COVERAGE = 0.5  # a: the share of a lobe within one texel of the level of its size
CACHED_PICTURES = 4  # whose filtered levels are kept, a few MB each


def texel_directions(side: int) -> FloatArray:
    """Return the directions (2, side, side, 3) of the texels' middles: discs z ≥ 0 and z < 0."""
    along = BORDER * ((np.arange(side) + 0.5) * 2 / side - 1)
    s, t = np.meshgrid(along, along)
    return np.stack([np.stack(from_disc(s, t, sign), axis=-1) for sign in (1, -1)])


def make_mips(base: FloatArray) -> list[FloatArray]:
    """Return `base` (2, side, side, channels), and its repeated means over 2×2 texels.

    >>> [level.shape[1] for level in make_mips(np.ones((2, 64, 64, 3)))]
    [64, 32, 16]
    """
    levels = [base]
    while levels[-1].shape[1] >= 2 * SMALLEST_SIDE:
        side = levels[-1].shape[1] // 2
        levels.append(levels[-1].reshape(2, side, 2, side, 2, -1).mean(axis=(2, 4)))
    return levels


def mip_level(kappa: JitFloat, z: JitFloat, side: int, coverage: float = COVERAGE) -> JitFloat:
    """Return the mip level whose texels are as large as the cap that holds a share of a lobe.

    The spherical cap holds the share `coverage` of the lobe's energy. This is eq. 8.9, for the
    concentration `kappa`, a direction with the component `z`, and a base of `side` texels.

    >>> round(mip_level(100.0, 0.5, 512, coverage=0.9), 5)
    5.75745
    """
    return 0.5 * dr.log2(cap_solid_angle(kappa, coverage) / texel_solid_angle(z, side))


def cap_solid_angle(kappa: JitFloat, coverage: float) -> JitFloat:
    """Return the solid angle [sr] about a lobe's axis that holds the share `coverage` of it."""
    return -2 * math.pi * math.log(1 - coverage) / kappa


def texel_solid_angle(z: JitFloat, side: int) -> JitFloat:
    """Return the solid angle [sr] of a texel at a direction, by eqs. 8.8 and 8.10."""
    return 4 * BORDER**2 * solid_angle(z) / side**2


def sharpest_kappa(side: float) -> float:
    """Return the κ of the sharpest lobe that a level of `side` texels resolves."""
    return (side / (4 * BORDER * TEXELS)) ** 2


def convolve_with_lobes(picture: FloatArray, side: float) -> list[FloatArray]:
    """Convolve a `picture` (height, 2 height, channels) with ever wider lobes.

    Their κ are `sharpest_kappa(side)`, its `STEP`-th part and so on. Returns discs (2, texels,
    texels, channels) for each. The last few results are kept, as most previews share their light.
    """
    pixels = np.asarray(picture, float).tobytes()
    return list(_convolve_with_lobes(pixels, picture.shape, side))


@lru_cache(CACHED_PICTURES)
def _convolve_with_lobes(pixels: bytes, shape: tuple[int, ...], side: float) -> list[FloatArray]:
    """Convolve a picture with ever wider lobes; its `pixels` are the bytes of doubles."""
    picture: FloatArray = np.frombuffer(pixels).reshape(shape)
    kappa, levels = sharpest_kappa(side), []
    while kappa > SMALLEST_KAPPA:
        while len(picture) > ROWS * max(side, SMALLEST_SIDE):
            picture = halve(picture)
        sharper = (1 + BLUR) * kappa

        def lobe(cos: AnyArray, kappa: float = sharper) -> AnyArray:
            return np.exp(log_density(cos, kappa))

        filtered = convolve(picture, lobe, math.acos(max(1 - CUT_OFF / kappa, -1)))
        levels.append(to_discs(filtered, max(round(side), SMALLEST_SIDE)))
        kappa, side = kappa / STEP, side / math.sqrt(STEP)
    return levels


def to_discs(picture: FloatArray, side: int) -> FloatArray:
    """Resample a `picture` by latitude and longitude as discs (2, side, side, channels)."""
    from scipy.ndimage import map_coordinates

    height, width = picture.shape[:2]
    x, y, z = np.moveaxis(texel_directions(side), -1, 0)
    around = 8  # pixels beyond each edge; behind a pole comes the opposite azimuth
    half = np.roll(picture, width // 2, axis=1)
    tall = np.concatenate([half[:around][::-1], picture, half[-around:][::-1]])
    wide = np.pad(tall, ((0, 0), (around, around), (0, 0)), mode="wrap")
    row = np.arccos(np.clip(z, -1, 1)) / np.pi * height - 0.5 + around
    column = np.arctan2(y, x) % (2 * np.pi) / (2 * np.pi) * width - 0.5 + around
    bands = [map_coordinates(band, [row, column]) for band in np.moveaxis(wide, -1, 0)]
    return np.stack(bands, axis=-1).clip(0)
