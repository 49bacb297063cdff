"""From spectral samples to linear sRGB."""

import re

import numpy as np

from brdfkit.colours import RGB, colour_science
from brdfkit.errors import BrdfkitError

ILLUMINANT = "D65"
OBSERVER = "CIE 1931 2 Degree Standard Observer"
# Without measurements on both sides of this range a colour would be a guess.
NEEDED = (480, 620)  # nm


def to_rgb(measured):
    """A `Measured` with wavelengths as channels, in linear sRGB under D65 (CIE 1931, 2°).

    Reflectance is linear between the wavelengths and constant beyond them; reflectance 1
    everywhere becomes (1, 1, 1). Colours outside sRGB keep their negative values.
    Raises `BrdfkitError` for channels that are no wavelengths or leave out much of the visible.

    >>> to_rgb(load("cayman.brdf")).channels  # doctest: +SKIP
    ('R', 'G', 'B')
    """
    known = wavelengths(measured)
    if known.min() > NEEDED[0] or known.max() < NEEDED[1]:
        raise BrdfkitError(
            f"{measured.name}: its wavelengths, {known.min():g} to {known.max():g} "
            f"nm, do not span {NEEDED[0]} to {NEEDED[1]} nm and give no colour; "
            "choose one channel with `mixed`."
        )
    note = f"linear sRGB from {len(known)} wavelengths under {ILLUMINANT}, {OBSERVER}"
    return measured.mixed(_weights(known), RGB, rgb=note)


def rgb_or_mean(data):
    """A `Measured` in linear sRGB, or the mean of its channels where they give no colour."""
    try:
        return data.rgb
    except BrdfkitError:
        n = len(data.channels)
        return data.mixed(np.full((n, 1), 1 / n), ("mean",))


def wavelengths(measured):
    """The channels of a `Measured` as wavelengths [nm]; `BrdfkitError` if they are none."""
    found = [re.fullmatch(r"(\d+(?:\.\d+)?)nm", channel) for channel in measured.channels]
    if not all(found):
        raise BrdfkitError(
            f"{measured.name}: the channels {', '.join(measured.channels)[:80]} have no known "
            "conversion to RGB; name them as wavelengths, such as '550nm'."
        )
    return np.array([float(match[1]) for match in found])


def _weights(wavelengths):
    """What each wavelength's reflectance adds to linear R, G, B: (n, 3), summing to 1."""
    colour = colour_science()

    observer = colour.MSDS_CMFS[OBSERVER]
    light = np.interp(
        observer.wavelengths,
        colour.SDS_ILLUMINANTS[ILLUMINANT].wavelengths,
        colour.SDS_ILLUMINANTS[ILLUMINANT].values,
    )
    order = np.argsort(wavelengths)
    between = np.stack(  # the hat function of each wavelength
        [np.interp(observer.wavelengths, wavelengths[order], row) for row in np.eye(len(order))]
    )
    xyz = between @ (light[:, None] * observer.values)
    rgb = xyz @ colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB.T
    weights = np.empty_like(rgb)
    # the sum is the illuminant's own colour, which differs from sRGB's white in the fourth digit
    weights[order] = rgb / rgb.sum(axis=0)
    return weights
