"""Linear sRGB, as Mitsuba and the pictures use it, and the colours of spectra."""

import numpy as np

from brdfkit.core.errors import BrdfkitError

RGB = ("R", "G", "B")  # names of the channels
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
ILLUMINANT = "D65"
OBSERVER = "CIE 1931 2 Degree Standard Observer"
# The wavelengths of a spectrum must span this range; otherwise its colour would be a guess
NEEDED = (480, 620)  # nm


def luminance(values):
    """Luminance (...) of values (..., 1), achromatic, or (..., 3), linear sRGB.

    >>> luminance(np.array([0.0, 1.0, 0.0]))
    np.float64(0.7152)
    """
    channels = values.shape[-1]
    if channels not in (1, 3):
        raise BrdfkitError(
            f"Values with {channels} channels have no luminance; convert them to RGB first."
        )
    return values[..., 0] if channels == 1 else values @ LUMINANCE


def to_srgb(linear):
    """sRGB's curve [IEC 1999]: values 0 to 1 of linear ones, which are clipped to 0 to 1.

    >>> to_srgb(np.array([0.0, 0.5, 2.0])).round(3)
    array([0.   , 0.735, 1.   ])
    """
    x = np.clip(linear, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def from_srgb(values):
    """Linear values of sRGB's curve [IEC 1999], 0 to 1; the inverse of `to_srgb`.

    >>> from_srgb(np.array([0.0, 0.735, 1.0])).round(3)
    array([0. , 0.5, 1. ])
    """
    y = np.clip(values, 0, 1)
    return np.where(y <= 0.04045, y / 12.92, ((y + 0.055) / 1.055) ** 2.4)


def import_colour():
    """The package `colour`, imported without its change of how NumPy prints arrays."""
    with np.printoptions():
        import colour
    return colour


def compute_rgb_weights(wavelengths, name):
    """Weights (n, 3) of the reflectance at each of the `wavelengths` [nm] in linear R, G, B.

    Reflectance is linear between the wavelengths and constant beyond them; every column sums to 1.
    Raises `BrdfkitError` for wavelengths of the material `name` that do not span 480 to 620 nm.
    """
    wavelengths = np.asarray(wavelengths, float)
    if wavelengths.min() > NEEDED[0] or wavelengths.max() < NEEDED[1]:
        raise BrdfkitError(
            f"{name}: its wavelengths, {wavelengths.min():g} to {wavelengths.max():g} "
            f"nm, do not span {NEEDED[0]} to {NEEDED[1]} nm and give no colour; "
            "choose one channel with `mix_channels`."
        )
    colour = import_colour()
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
