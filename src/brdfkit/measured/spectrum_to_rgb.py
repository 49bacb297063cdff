"""Converts spectral measurements to linear sRGB, and reads wavelengths from channel names."""

import re

import numpy as np

from brdfkit.colours import RGB, colour_science
from brdfkit.errors import BrdfkitError

ILLUMINANT = "D65"
OBSERVER = "CIE 1931 2 Degree Standard Observer"
# The wavelengths must span this range; otherwise a colour would be a guess
NEEDED = (480, 620)  # nm


def to_rgb(data):
    """A `Measured` whose channels are wavelengths, in linear sRGB under D65 (CIE 1931, 2°).

    Reflectance is linear between the wavelengths and constant beyond them; reflectance 1 at all
    wavelengths becomes (1, 1, 1). Colours outside sRGB keep their negative values. Raises
    `BrdfkitError` for channels that are no wavelengths, or that do not span 480 to 620 nm.

    >>> to_rgb(load("cayman.brdf")).channels  # doctest: +SKIP
    ('R', 'G', 'B')
    """
    known = wavelengths(data)
    if known.min() > NEEDED[0] or known.max() < NEEDED[1]:
        raise BrdfkitError(
            f"{data.name}: its wavelengths, {known.min():g} to {known.max():g} "
            f"nm, do not span {NEEDED[0]} to {NEEDED[1]} nm and give no colour; "
            "choose one channel with `mixed`."
        )
    note = f"linear sRGB from {len(known)} wavelengths under {ILLUMINANT}, {OBSERVER}"
    return data.mixed(_weights(known), RGB, rgb=note)


def rgb_or_mean(data):
    """A `Measured` in linear sRGB, or the mean of its channels where they give no colour."""
    try:
        return data.rgb
    except BrdfkitError:
        n = len(data.channels)
        return data.mixed(np.full((n, 1), 1 / n), ("mean",))


def wavelengths(data):
    """The channels of a `Measured` as wavelengths [nm] (channels,).

    Raises `BrdfkitError` unless all are named so, as ``"400nm"``.
    """
    found = [re.fullmatch(r"(\d+(?:\.\d+)?)nm", channel) for channel in data.channels]
    if not all(found):
        raise BrdfkitError(
            f"{data.name}: the channels {', '.join(data.channels)[:80]} have no known "
            "conversion to RGB; name them as wavelengths, such as '550nm'."
        )
    return np.array([float(match[1]) for match in found])


def _weights(wavelengths):
    """Weights (n, 3) of each wavelength's reflectance in linear R, G, B; every column sums to 1."""
    colour = colour_science()

    observer = colour.MSDS_CMFS[OBSERVER]
    light = np.interp(
        observer.wavelengths,
        colour.SDS_ILLUMINANTS[ILLUMINANT].wavelengths,
        colour.SDS_ILLUMINANTS[ILLUMINANT].values,
    )
    # Between the wavelengths reflectance is linear: a hat function for each
    order = np.argsort(wavelengths)
    hats = np.stack(
        [np.interp(observer.wavelengths, wavelengths[order], row) for row in np.eye(len(order))]
    )
    # Integrate over the observer and the illuminant; XYZ to sRGB
    xyz = hats @ (light[:, None] * observer.values)
    rgb = xyz @ colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB.T
    weights = np.empty_like(rgb)
    # White becomes (1, 1, 1): the rows add up to the colour of the illuminant, which differs from
    # sRGB's white in the fourth digit
    weights[order] = rgb / rgb.sum(axis=0)
    return weights
