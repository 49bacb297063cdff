"""Converts spectra to linear sRGB, Mitsuba's colours, and linear sRGB to sRGB for screens."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError

RGB = ("R", "G", "B")  # names of the three colour channels
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # weights of linear R, G and B in luminance
ILLUMINANT = "D65"
OBSERVER = "CIE 1931 2 Degree Standard Observer"
# The wavelengths of a spectrum must span this range; otherwise its colour would be a guess
REQUIRED_RANGE = (480, 620)  # nm


def luminance(values: FloatArray) -> FloatArray:
    """Return the luminance (...) of linear sRGB (..., 3), or the one channel of values (..., 1).

    >>> luminance(np.array([0.0, 1.0, 0.0]))
    np.float64(0.7152)
    """
    channels = values.shape[-1]
    if channels not in (1, 3):
        raise BrdfkitError(
            f"Values with {channels} channels have no luminance; convert them to RGB first."
        )
    return values[..., 0] if channels == 1 else values @ LUMINANCE


def to_srgb(linear: ArrayLike) -> FloatArray:
    """Encode linear values, clipped to [0, 1], by the curve of sRGB [IEC 1999] for screens.

    >>> to_srgb(np.array([0.0, 0.5, 2.0])).round(3)
    array([0.   , 0.735, 1.   ])
    """
    x = np.clip(linear, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def from_srgb(values: ArrayLike) -> FloatArray:
    """Decode sRGB values, clipped to [0, 1], to linear values by the inverse curve [IEC 1999].

    >>> from_srgb(np.array([0.0, 0.7354, 1.0])).round(3)
    array([0. , 0.5, 1. ])
    """
    y = np.clip(values, 0, 1)
    return np.where(y <= 0.04045, y / 12.92, ((y + 0.055) / 1.055) ** 2.4)


def import_colour_package() -> Any:
    """Import the package `colour` without letting it change how NumPy prints arrays."""
    with np.printoptions():
        import colour
    return colour


def compute_rgb_weights(wavelengths: ArrayLike, name: str) -> FloatArray:
    """Compute the matrix (n, 3) that converts reflectances at n wavelengths [nm] to linear sRGB.

    Reflectance is linear between the wavelengths and constant beyond them; every column sums to 1.
    Raises `BrdfkitError` for wavelengths of the material `name` that do not span 480 to 620 nm.
    """
    wavelengths = np.asarray(wavelengths, float)
    if wavelengths.min() > REQUIRED_RANGE[0] or wavelengths.max() < REQUIRED_RANGE[1]:
        raise BrdfkitError(
            f"{name}: its wavelengths, {wavelengths.min():g} to {wavelengths.max():g} "
            f"nm, do not span {REQUIRED_RANGE[0]} to {REQUIRED_RANGE[1]} nm and give no colour; "
            "choose one channel with `mix_channels`."
        )
    colour = import_colour_package()
    observer = colour.MSDS_CMFS[OBSERVER]
    light = np.interp(
        observer.wavelengths,
        colour.SDS_ILLUMINANTS[ILLUMINANT].wavelengths,
        colour.SDS_ILLUMINANTS[ILLUMINANT].values,
    )
    # A hat function for each wavelength, 1 there, 0 at the others, and linear between them
    order = np.argsort(wavelengths)
    hats = np.stack(
        [np.interp(observer.wavelengths, wavelengths[order], row) for row in np.eye(len(order))]
    )
    # The XYZ of each hat under the illuminant, by the observer's curves; then XYZ to linear sRGB
    xyz = hats @ (light[:, None] * observer.values)
    rgb = xyz @ colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB.T
    weights = np.empty_like(rgb)
    # Scale white to (1, 1, 1): the rows add up to the colour of the illuminant, which differs from
    # the white of sRGB in the fourth digit
    weights[order] = rgb / rgb.sum(axis=0)
    return weights
