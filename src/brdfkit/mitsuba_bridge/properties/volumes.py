"""Volumes that a scene gives to a plugin: checks them, and makes one of a colour."""

import numpy as np


def require_volume(volume, coloured, least=0.0):
    """Raise a ValueError, which says what a `mi.Volume` should be, unless its values are usable.

    They are finite and `least` or more; unless `coloured`, there is one of them at a point. Those
    within a plugin of ours were checked as that was made.
    """
    import mitsuba as mi

    parameters = mi.traverse(volume)
    for name in parameters.keys():  # noqa: SIM118
        if name.startswith("values.") or not (name == "data" or name.endswith("value")):
            continue
        values = np.array(parameters[name], float)
        channels = values.shape[-1] if values.ndim == 4 else values.size
        if channels > 1 and not coloured:
            raise ValueError("a volume of one channel")
        if channels > 1 and mi.is_spectral:  # the coefficients of spectra
            continue
        if not np.isfinite(values).all() or values.min() < least:
            limit = ", not negative" if least == 0 else ""
            raise ValueError(f"a volume of finite values{limit}")


def make_constant_volume(value):
    """A volume of one `value`, a number or a dictionary of Mitsuba's."""
    import mitsuba as mi

    return mi.load_dict({"type": "constvolume", "value": value}, parallel=False)


def make_coloured_volume(colour):
    """A volume of one colour, in linear sRGB.

    In spectral variants it is a grid: Mitsuba's constvolume clips a colour above 1 there, unsaid.
    """
    import mitsuba as mi

    colour = np.array(colour, np.float32).reshape(3)
    if not np.isfinite(colour).all() or colour.min() < 0:
        raise ValueError("a colour of finite values, not negative")
    if not mi.is_spectral:
        return make_constant_volume({"type": "rgb", "value": colour.tolist()})
    grid = mi.VolumeGrid(np.broadcast_to(colour, (2, 2, 2, 3)).copy())
    return mi.load_dict({"type": "gridvolume", "grid": grid}, parallel=False)
