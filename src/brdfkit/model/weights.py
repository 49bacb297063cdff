"""Reads, checks and converts values of weights: a number, linear R, G, B, or a spectrum."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from brdfkit.core.colours import compute_rgb_weights
from brdfkit.core.errors import BrdfkitError

CHANNELS = 1, 3  # allowed lengths of a weight without wavelengths: achromatic, linear sRGB
VISIBLE = 360.0, 830.0  # [nm] range of the wavelengths in Mitsuba's spectral variants
LARGEST_COUNT = 3  # a weight with more numbers than this is printed by its range


def check_wavelengths(wavelengths: Any, what: str) -> tuple[float, ...]:
    """Return wavelengths [nm] as a tuple; raise `BrdfkitError` unless they differ and are above 0.

    `what` is the model's name in the error message.
    """
    try:
        numbers = tuple(map(float, wavelengths))
    except (TypeError, ValueError):
        numbers = (np.nan,)
    if len(set(numbers)) != len(numbers) or not all(0 < w < np.inf for w in numbers):
        raise BrdfkitError(
            f"{what}: wavelengths = {wavelengths!r} should be different numbers above 0 [nm]."
        )
    return numbers


def read_value(
    value: Any, per_channel: bool, wavelengths: Sequence[float], what: str
) -> float | tuple[float, ...]:
    """Convert a parameter's value to a float, or to a tuple of one float per channel.

    `per_channel` is True for weights. Raises `BrdfkitError` for another value; `what` is the
    parameter's name in its message.
    """
    lengths = (1, len(wavelengths)) if wavelengths else CHANNELS
    try:
        if np.ndim(value) == 0:
            return float(value)
        if per_channel and np.ndim(value) == 1 and len(value) in lengths:
            return tuple(float(v) for v in value)
    except (TypeError, ValueError):
        pass
    expected = "a number"
    if per_channel:
        several = f"{len(wavelengths)}, one per wavelength" if wavelengths else "three for R, G, B"
        expected = f"a number, or {several}"
    given = repr(value)
    given = given if len(given) < 200 else f"{given[:200]}…"
    raise BrdfkitError(f"{what} = {given} should be {expected}.")


def to_rgb_values(model: Any) -> dict[str, Any]:
    """Return a spectral model's values by name, with its weights converted to linear sRGB.

    A colour outside sRGB is clipped to the bounds of its weight.
    """
    mix, values = compute_rgb_weights(model.wavelengths, model.name), dict(model.free_values)
    for name, value in values.items():
        if isinstance(value, tuple) and len(value) > 1:
            low, high = model.parameters[name].bounds
            values[name] = np.clip(value @ mix, low, high)
    return values


def to_mitsuba_entries(model: Any) -> dict[str, Any]:
    """Convert a model's values to entries of Mitsuba's dictionaries: colour, spectrum or number."""
    entries = {}
    for name, value in model.free_values.items():
        if isinstance(value, tuple) and model.wavelengths:
            value = _make_spectrum(value, model.wavelengths, f"{model.type_name()}: {name}")
        elif isinstance(value, tuple):
            value = {"type": "rgb", "value": list(value * 3 if len(value) == 1 else value)}
        entries[name] = value
    return entries


def _make_spectrum(value: tuple[float, ...], wavelengths: Sequence[float], what: str) -> Any:
    """Make Mitsuba's spectrum of one number per wavelength.

    It is linear between the wavelengths and constant beyond them. `what` is the parameter's name
    in error messages.
    """
    if min(value) < 0:
        raise BrdfkitError(
            f"{what} is a spectrum with a value below 0, which Mitsuba does not support; use an "
            "rgb or mono variant, or save the material as .bsdf."
        )
    if len(value) == 1 or max(value) == 0:  # Mitsuba refuses a spectrum that is 0 everywhere
        return value[0]
    nodes, values = zip(*sorted(zip(wavelengths, value, strict=True)), strict=True)
    ends = min(VISIBLE[0], nodes[0] - 1), max(VISIBLE[1], nodes[-1] + 1)
    return {
        "type": "irregular",
        "wavelengths": ", ".join(map(repr, (ends[0], *nodes, ends[1]))),
        "values": ", ".join(map(repr, (values[0], *values, values[-1]))),
    }


def format_value(value: Any) -> str:
    """Format a parameter's value as a short text, such as "0.3" or "[0.1, 0.2, 0.3]"."""
    if not isinstance(value, tuple):
        return f"{value:.4g}"
    if len(value) > LARGEST_COUNT:
        return f"[{len(value)} from {min(value):.4g} to {max(value):.4g}]"
    return "[" + ", ".join(f"{v:.4g}" for v in value) + "]"
