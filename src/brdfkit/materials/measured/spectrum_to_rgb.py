"""Converts spectral measurements to linear sRGB, and reads wavelengths from channel names."""

import re

import numpy as np

from brdfkit.core.colours import ILLUMINANT, OBSERVER, RGB, rgb_of_wavelengths
from brdfkit.core.errors import BrdfkitError

WAVELENGTH = re.compile(r"\d+(\.\d+)?nm")


def to_rgb(data):
    """A `Measured` whose channels are wavelengths, in linear sRGB under D65 (CIE 1931, 2°).

    Reflectance is linear between the wavelengths and constant beyond them; reflectance 1 at all
    wavelengths becomes (1, 1, 1). Colours outside sRGB keep their negative values. Raises
    `BrdfkitError` for channels that are no wavelengths, or that do not span 480 to 620 nm.

    >>> to_rgb(load("cayman.brdf")).channels  # doctest: +SKIP
    ('R', 'G', 'B')
    """
    known = wavelengths(data)
    weights = rgb_of_wavelengths(known, data.name)
    note = f"linear sRGB from {len(known)} wavelengths under {ILLUMINANT}, {OBSERVER}"
    return data.mixed(weights, RGB, rgb=note)


def rgb_or_mean(data):
    """A `Measured` in linear sRGB, or the mean of its channels where they give no colour."""
    try:
        return data.rgb
    except BrdfkitError:
        n = len(data.channels)
        return data.mixed(np.full((n, 1), 1 / n), ("mean",))


def has_wavelengths(data):
    """Whether the channels of a `Measured` are all named as wavelengths, as ``"400nm"``."""
    return all(map(WAVELENGTH.fullmatch, data.channels))


def wavelengths(data):
    """The channels of a `Measured` as wavelengths [nm] (channels,).

    Raises `BrdfkitError` unless all are named so.
    """
    if not has_wavelengths(data):
        raise BrdfkitError(
            f"{data.name}: the channels {', '.join(data.channels)[:80]} have no known "
            "conversion to RGB; name them as wavelengths, such as '550nm'."
        )
    return np.array([float(channel.removesuffix("nm")) for channel in data.channels])
