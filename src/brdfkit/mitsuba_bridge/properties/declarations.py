"""Declares the parameters of a plugin that is no model; one base class reads and checks them.

PARAMETERS = {"k": number(0.5, (-0.999, 0.999), "asymmetry: above 0 forward, below 0 back")}

def define(mi):
    class Schlick(declared(mi.PhaseFunction, PARAMETERS)): ...
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from brdfkit.core.arguments import describe_range, is_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.properties.conversions import is_colour
from brdfkit.mitsuba_bridge.properties.volumes import (
    make_coloured_volume,
    make_constant_volume,
    require_volume,
)


@dataclass(frozen=True)
class Setting:
    """A parameter of a plugin, with its `default`, its `bounds` (low, high) and its `meaning`.

    `bounds` are None for a parameter that is not a number. `read(value)` converts a property to
    what the plugin uses, or raises a ValueError that says what it should be. `differentiable`:
    whether an optimiser may change it.
    """

    default: Any
    bounds: tuple[float, float] | None
    meaning: str
    read: Callable
    differentiable: bool = False


def number(default, bounds, meaning):
    """A number within `bounds` (low, high), differentiable; opaque: any value has one kernel."""

    def read(value):
        import drjit as dr
        import mitsuba as mi

        opaque = mi.Float(_to_number(value, bounds))
        dr.make_opaque(opaque)
        return opaque

    return Setting(default, bounds, meaning, read, differentiable=True)


def count(default, bounds, meaning):
    """A whole number within `bounds`, a Python value: each value compiles a kernel of its own."""

    def read(value):
        number = _to_number(value, bounds)
        if not number.is_integer():
            raise ValueError("a whole number")
        return int(number)

    return Setting(default, bounds, meaning, read)


def plain_number(default, bounds, meaning):
    """A number within `bounds`, a Python value: for what is computed before a render."""

    def read(value):
        return _to_number(value, bounds)

    return Setting(default, bounds, meaning, read)


def text(default, meaning):
    """A word or the name of a file."""

    def read(value):
        if not isinstance(value, str):
            raise ValueError("a text")
        return value

    return Setting(default, None, meaning, read)


def word(allowed, meaning, default=None):
    """One of the `allowed` words; the `default` is the first of them unless said."""

    def read(value):
        if not isinstance(value, str) or value not in allowed:
            raise ValueError("one of " + ", ".join(allowed))
        return value

    default = default or next(iter(allowed))
    return Setting(default, None, f"{meaning}: {', '.join(allowed)}", read)


def flag(default, meaning):
    """True or false."""

    def read(value):
        if not isinstance(value, bool):
            raise ValueError("true or false")
        return value

    return Setting(default, None, meaning, read)


def picture(meaning):
    """A `mi.Bitmap`, None where the scene gives none."""

    def read(value):
        import mitsuba as mi

        if not isinstance(value, mi.Bitmap | None):
            raise ValueError("a mitsuba.Bitmap")
        return value

    return Setting(None, None, meaning, read)


def bsdf(meaning):
    """A BSDF, white and matte where the scene gives none."""

    def read(value):
        import mitsuba as mi

        if value is None:
            white = {"type": "rgb", "value": 1.0}
            return mi.load_dict({"type": "diffuse", "reflectance": white}, parallel=False)
        if not isinstance(value, mi.BSDF):
            raise ValueError("a bsdf")
        return value

    return Setting(None, None, meaning, read, differentiable=True)


def texture(default, meaning):
    """A texture of numbers; one number makes a constant one."""

    def read(value):
        import mitsuba as mi

        if isinstance(value, mi.Texture):
            return value
        if not is_number(value):
            raise ValueError("a texture or a number")
        return mi.load_dict({"type": "uniform", "value": float(value)}, parallel=False)

    return Setting(default, None, meaning, read, differentiable=True)


def phase(meaning):
    """A phase function, by which light goes evenly anywhere where the scene gives none."""

    def read(value):
        import mitsuba as mi

        if value is None:
            return mi.load_dict({"type": "isotropic"}, parallel=False)
        if not isinstance(value, mi.PhaseFunction):
            raise ValueError("a phase function")
        return value

    return Setting(None, None, meaning, read, differentiable=True)


def volume(default, meaning, coloured=True, least=0.0):
    """A volume of values from `least` on, such as Mitsuba's gridvolume; a number or a colour makes
    a constant one. Not `coloured`: of one channel."""

    def read(value):
        import mitsuba as mi

        if isinstance(value, mi.Volume):
            require_volume(value, coloured, least)
            return value
        if coloured and is_colour(value):
            return make_coloured_volume(value)
        if not is_number(value):
            constant = "a number or a colour" if coloured else "or a number"
            raise ValueError(f"a volume, such as a gridvolume, {constant}")
        return make_constant_volume(_to_number(value, (least, math.inf)))

    return Setting(default, None, meaning, read, differentiable=True)


def read_settings(settings, get, owner):
    """Name → value of `settings` (name → `Setting`), from `get(name, default)`.

    Raises `BrdfkitError`, which names the `owner`, for a value that is none of the allowed ones.
    """
    found = {}
    for name, setting in settings.items():
        value = get(name, setting.default)
        try:
            found[name] = setting.read(value)
        except (TypeError, ValueError) as error:
            said = f"{owner}: {name} = {_shorten(value)} should be {error}."
            raise BrdfkitError(said) from error
    return found


def derive_plugin(base, parameters):
    """A class derived from `base`, one of Mitsuba's, with the `parameters` (name → `Setting`).

    Each is an attribute of an instance; the differentiable ones are exposed to optimisers.
    """

    class Declared(base):
        def __init__(self, props):
            super().__init__(props)
            for name, value in read_settings(parameters, props.get, props.plugin_name()).items():
                setattr(self, name, value)

        def traverse(self, callback):
            import mitsuba as mi

            for name, setting in parameters.items():
                if setting.differentiable:
                    callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

        def to_string(self):
            lines = [f"  {name} = {getattr(self, name)}" for name in parameters]
            return "\n".join([f"{type(self).__name__}[", *lines, "]"])

    return Declared


def _to_number(value, bounds):
    """Return a property as a float; raise a ValueError for what is no number within `bounds`."""
    low, high = bounds
    if not (is_number(value) and low <= value <= high):
        raise ValueError(describe_range("a number", low, high))
    return float(value)


def _shorten(value):
    """`value` as text in one line of at most 60 characters."""
    return " ".join(str(value).split())[:60]
