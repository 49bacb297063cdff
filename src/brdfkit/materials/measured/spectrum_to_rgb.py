"""Converts spectral measurements to linear sRGB, and reads wavelengths from channel names."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.colours import ILLUMINANT, OBSERVER, RGB, compute_rgb_weights
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.arithmetic import mix_channels
from brdfkit.materials.measured.measured_data import Data, MeasuredData

WAVELENGTH = re.compile(r"\d+(\.\d+)?nm")


def to_rgb(data: Data) -> Data:
    """Convert a `Measured` with wavelengths as channels to linear sRGB, under D65 (CIE 1931, 2°).

    Reflectance is taken as linear between the wavelengths and constant beyond them. A spectrum of 1
    becomes (1, 1, 1). Colours outside sRGB keep their negative values. Raises `BrdfkitError` for
    channels that are no wavelengths, or that do not span 480 to 620 nm.

    >>> to_rgb(load("cayman.brdf")).channels  # doctest: +SKIP
    ('R', 'G', 'B')
    """
    nanometres = wavelengths(data)
    weights = compute_rgb_weights(nanometres, data.name)
    note = f"linear sRGB from {len(nanometres)} wavelengths under {ILLUMINANT}, {OBSERVER}"
    return mix_channels(data, weights, RGB, {**data.info, "rgb": note})


def to_rgb_or_mean(data: Any) -> Any:
    """Convert a `Measured` to linear sRGB, or to its channels' mean where they give no colour."""
    try:
        return data.rgb
    except BrdfkitError:
        n = len(data.channels)
        return mix_channels(data, np.full((n, 1), 1 / n), ("mean",), data.info)


def has_wavelengths(data: MeasuredData) -> bool:
    """Return whether all channels of a `Measured` are named as wavelengths, such as ``"400nm"``."""
    return all(map(WAVELENGTH.fullmatch, data.channels))


def format_channels(channels: Sequence[str]) -> str:
    """Return a text that names up to five channels, or else the first and the last."""
    if len(channels) > 5:
        return f"{len(channels)} wavelengths, {channels[0]} to {channels[-1]}"
    return " ".join(channels)


def wavelengths(data: MeasuredData) -> NDArray[np.float64]:
    """Return the wavelengths [nm] (channels,) of a `Measured`, by the names of its channels.

    Raises `BrdfkitError` unless all channels are named as wavelengths.
    """
    if not has_wavelengths(data):
        raise BrdfkitError(
            f"{data.name}: the channels {', '.join(data.channels)[:80]} have no known "
            "conversion to RGB; name them as wavelengths, such as '550nm'."
        )
    return np.array([float(channel.removesuffix("nm")) for channel in data.channels])
