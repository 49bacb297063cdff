"""Checks volumes that a scene gives to a plugin, and makes volumes of one value or colour."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike, MitsubaObject


def require_volume(volume: MitsubaObject, coloured: bool, least: float = 0.0) -> None:
    """Raise a ValueError, which says what a `mi.Volume` should be, unless its values are usable.

    The values have to be finite and `least` or more; unless `coloured`, there is one value at a
    point. Volumes within one of brdfkit's plugins were checked when that was made.
    """
    import mitsuba as mi

    parameters = mi.traverse(volume)
    for name in parameters.keys():  # noqa: SIM118
        if name.startswith("values.") or not (name == "data" or name.endswith("value")):
            continue
        values = np.asarray(parameters[name])
        channels = values.shape[-1] if values.ndim == 4 else values.size
        if channels > 1 and not coloured:
            raise ValueError("a volume of one channel")
        if channels > 1 and mi.is_spectral:  # coefficients of spectra, no colours
            continue
        low, high = values.min(), values.max()  # NaN if any value is
        if not (np.isfinite(low) and np.isfinite(high)) or low < least:
            limit = ", not negative" if least == 0 else ""
            raise ValueError(f"a volume of finite values{limit}")


def make_constant_volume(value: Any) -> MitsubaObject:
    """Make a volume of one value, a number or a dictionary of Mitsuba's."""
    import mitsuba as mi

    return mi.load_dict({"type": "constvolume", "value": value}, parallel=False)


def make_coloured_volume(colour: ArrayLike) -> MitsubaObject:
    """Make a volume of one colour in linear sRGB.

    In spectral variants it is a grid, since Mitsuba's constvolume silently clips a colour above 1
    there.
    """
    import mitsuba as mi

    rgb = np.array(colour, np.float32).reshape(3)
    if not np.isfinite(rgb).all() or rgb.min() < 0:
        raise ValueError("a colour of finite values, not negative")
    if not mi.is_spectral:
        return make_constant_volume({"type": "rgb", "value": rgb.tolist()})
    grid = mi.VolumeGrid(np.broadcast_to(rgb, (2, 2, 2, 3)).copy())
    return mi.load_dict({"type": "gridvolume", "grid": grid}, parallel=False)
