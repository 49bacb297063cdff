"""The levels of a filtered map of all directions, each a pair of square dual-paraboloid pictures.

Either the levels of graphics hardware, each texel the mean of four of the level before; or maps
convolved with von Mises-Fisher lobes of known concentration κ, two levels for each halving, so
that what is read for a κ is right, and not only about as wide. A square is larger
than its disc by the factor `BORDER`: it holds some of the other side, and may be interpolated at
the rim.

[Ergun 2015, eqs. 8.8-8.10, whose b is `BORDER`]
"""

import math

import drjit as dr
import numpy as np

from brdfkit.core.geometry.dual_paraboloid import from_disc, solid_angle
from brdfkit.lighting.filtering.sphere_filter import convolve, halve

BORDER = 1.2
LEAST_SIDE = 16  # of a level [texels]: a smaller one's border is too narrow to interpolate
TEXELS = 2.0  # per standard deviation κ^-1/2 of a lobe, where a disc has fewest: at its middle
STEP = 2**0.5  # between the κ of levels: a lobe between two is nearly the mean of theirs
ROWS = 1.7  # of a picture, at most, per texel of the discs that are made of it
LEAST_KAPPA = 0.5  # all but even: a wider lobe is read as this one
NOTHING = 12.0  # e^-12 of its peak, and of its integral beyond: where a lobe ends
# Interpolation between texels adds about this share to the variance of a lobe, so that the map is
# convolved with one that much sharper
BLUR = 0.03
COVERAGE = 0.5  # a: the share of a lobe within one texel of the level of its size


def texel_directions(side):
    """The directions (2, side, side, 3) of the texels' middles: the discs of z ≥ 0 and of z < 0."""
    along = BORDER * ((np.arange(side) + 0.5) * 2 / side - 1)
    s, t = np.meshgrid(along, along)
    return np.stack([np.stack(from_disc(s, t, sign), axis=-1) for sign in (1, -1)])


def mips(base):
    """`base` (2, side, side, channels), and below it its means of 2×2 texels, while these fit.

    >>> [level.shape[1] for level in mips(np.ones((2, 64, 64, 3)))]
    [64, 32, 16]
    """
    levels = [base]
    while levels[-1].shape[1] >= 2 * LEAST_SIDE:
        side = levels[-1].shape[1] // 2
        levels.append(levels[-1].reshape(2, side, 2, side, 2, -1).mean(axis=(2, 4)))
    return levels


def mip_level(kappa, z, side, coverage=COVERAGE):
    """The level whose texel at a direction is as large as the cap that holds a share of a lobe.

    Eq. 8.9, for the concentration `kappa` and the component `z` of the direction; `side` [texels]
    of the base; `coverage`: that share.

    >>> round(mip_level(100.0, 0.5, 512, coverage=0.9), 5)
    5.75745
    """
    return 0.5 * dr.log2(cap(kappa, coverage) / texel_solid_angle(z, side))


def cap(kappa, coverage):
    """Solid angle [sr] about the axis of a lobe that holds the share `coverage` of it."""
    return -2 * math.pi * math.log(1 - coverage) / kappa


def texel_solid_angle(z, side):
    """Solid angle [sr] of a texel at a direction, eqs. 8.8 and 8.10."""
    return 4 * BORDER**2 * solid_angle(z) / side**2


def sharpest(side):
    """κ of the sharpest lobe that a level of `side` texels resolves."""
    return (side / (4 * BORDER * TEXELS)) ** 2


def lobe_maps(picture, side):
    """The `picture` (height, 2 height, channels), convolved with lobes of κ = `sharpest(side)`,
    the `STEP`-th part of that and so on, each as discs (2, texels, texels, channels)."""
    kappa, found = sharpest(side), []
    while kappa > LEAST_KAPPA:
        while len(picture) > ROWS * max(side, LEAST_SIDE):
            picture = halve(picture)
        reach = math.acos(max(1 - NOTHING / kappa, -1))
        filtered = convolve(picture, lambda cos, kappa=kappa: lobe(cos, (1 + BLUR) * kappa), reach)
        found.append(discs(filtered, max(round(side), LEAST_SIDE)))
        kappa, side = kappa / STEP, side / math.sqrt(STEP)
    return found


def lobe(cos, kappa):
    """The von Mises-Fisher density [sr⁻¹] at the cosine to its axis, eq. 8.1 in its stable form."""
    return kappa / (2 * np.pi * -np.expm1(-2 * kappa)) * np.exp(kappa * (cos - 1))


def discs(picture, side):
    """A `picture` by latitude and longitude, as discs (2, side, side, channels), smooth between
    pixels."""
    from scipy.ndimage import map_coordinates

    height, width = picture.shape[:2]
    x, y, z = np.moveaxis(texel_directions(side), -1, 0)
    around = 8  # pixels beyond each edge: behind a pole comes the opposite azimuth
    half = np.roll(picture, width // 2, axis=1)
    tall = np.concatenate([half[:around][::-1], picture, half[-around:][::-1]])
    wide = np.pad(tall, ((0, 0), (around, around), (0, 0)), mode="wrap")
    row = np.arccos(np.clip(z, -1, 1)) / np.pi * height - 0.5 + around
    column = np.arctan2(y, x) % (2 * np.pi) / (2 * np.pi) * width - 0.5 + around
    bands = [map_coordinates(band, [row, column]) for band in np.moveaxis(wide, -1, 0)]
    return np.stack(bands, axis=-1).clip(0)
