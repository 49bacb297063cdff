"""Declares the parameters of a plugin that is no model; one base class reads and checks them.

PARAMETERS = {"k": declare_number(0.5, (-0.999, 0.999), "asymmetry: above 0 forward, below 0 back")}

def define(mi):
    class Schlick(derive_plugin(mi.PhaseFunction, PARAMETERS)): ...
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.arguments import describe_range, is_number
from brdfkit.core.array_types import MitsubaObject
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

    `bounds` are None for a parameter that is not a number. `read(value)` converts a property to the
    value that the plugin uses, or raises a ValueError that says what the property should be.
    `differentiable` says whether an optimiser may change it.
    """

    default: Any
    bounds: tuple[float, float] | None
    meaning: str
    read: Callable[[Any], Any]
    differentiable: bool = False


def declare_number(default: float, bounds: tuple[float, float], meaning: str) -> Setting:
    """Declare a differentiable number within `bounds`; all its values share one compiled kernel."""

    def read_number(value: Any) -> Any:
        import drjit as dr
        import mitsuba as mi

        opaque = mi.Float(_convert_to_number(value, bounds))
        dr.make_opaque(opaque)
        return opaque

    return Setting(default, bounds, meaning, read_number, differentiable=True)


def declare_int(default: int, bounds: tuple[float, float], meaning: str) -> Setting:
    """Declare a whole number within `bounds`; each of its values compiles a kernel of its own."""

    def read_int(value: Any) -> int:
        number = _convert_to_number(value, bounds)
        if not number.is_integer():
            raise ValueError("a whole number")
        return int(number)

    return Setting(default, bounds, meaning, read_int)


def declare_float(default: float, bounds: tuple[float, float], meaning: str) -> Setting:
    """Declare a Python float within `bounds`, for computations before a render."""

    def read_float(value: Any) -> float:
        return _convert_to_number(value, bounds)

    return Setting(default, bounds, meaning, read_float)


def declare_text(default: str, meaning: str) -> Setting:
    """Declare a text, such as the name of a file."""

    def read_text(value: Any) -> str:
        if not isinstance(value, str):
            raise ValueError("a text")
        return value

    return Setting(default, None, meaning, read_text)


def declare_choice(
    allowed: Sequence[str] | Mapping[str, Any], meaning: str, default: str | None = None
) -> Setting:
    """Declare a choice of one of the `allowed` words, by default the first one."""

    def read_choice(value: Any) -> str:
        if not isinstance(value, str) or value not in allowed:
            raise ValueError("one of " + ", ".join(allowed))
        return value

    default = default or next(iter(allowed))
    return Setting(default, None, f"{meaning}: {', '.join(allowed)}", read_choice)


def declare_bool(default: bool, meaning: str) -> Setting:
    """Declare a parameter that is true or false."""

    def read_bool(value: Any) -> bool:
        if not isinstance(value, bool):
            raise ValueError("true or false")
        return value

    return Setting(default, None, meaning, read_bool)


def declare_point(default: tuple[float, float, float], meaning: str) -> Setting:
    """Declare three coordinates; any values of them use the same kernel."""

    def read_point(value: Any) -> Any:
        import drjit as dr
        import mitsuba as mi

        try:
            point = mi.Point3f(*(float(coordinate) for coordinate in value))
        except (TypeError, ValueError):
            raise ValueError("three numbers") from None
        dr.make_opaque(point)
        return point

    return Setting(default, None, meaning, read_point, differentiable=True)


def declare_radiance(meaning: str) -> Setting:
    """Declare a radiance, a number or a colour, which is None where the scene gives none."""

    def read_radiance(value: Any) -> Any:
        import drjit as dr
        import mitsuba as mi

        if value is None:
            return None
        if not (is_colour(value) or is_number(value)):
            raise ValueError("a number or a colour")
        radiance = mi.Color3f(list(value) if is_colour(value) else value)
        dr.make_opaque(radiance)
        return radiance

    return Setting(None, None, meaning, read_radiance, differentiable=True)


def declare_picture(meaning: str) -> Setting:
    """Declare a `mi.Bitmap`, which is None where the scene gives none."""

    def read_picture(value: Any) -> Any:
        import mitsuba as mi

        if not isinstance(value, mi.Bitmap | None):
            raise ValueError("a mitsuba.Bitmap")
        return value

    return Setting(None, None, meaning, read_picture)


def declare_bsdf(meaning: str) -> Setting:
    """Declare a BSDF, which is white and matt where the scene gives none."""

    def read_bsdf(value: Any) -> Any:
        import mitsuba as mi

        if value is None:
            white = {"type": "rgb", "value": 1.0}
            return mi.load_dict({"type": "diffuse", "reflectance": white}, parallel=False)
        if not isinstance(value, mi.BSDF):
            raise ValueError("a bsdf")
        return value

    return Setting(None, None, meaning, read_bsdf, differentiable=True)


def declare_texture(default: float, meaning: str) -> Setting:
    """Declare a texture of numbers; one number makes a constant texture."""

    def read_texture(value: Any) -> Any:
        import mitsuba as mi

        if isinstance(value, mi.Texture):
            return value
        if not is_number(value):
            raise ValueError("a texture or a number")
        return mi.load_dict({"type": "uniform", "value": float(value)}, parallel=False)

    return Setting(default, None, meaning, read_texture, differentiable=True)


def declare_normals(meaning: str) -> Setting:
    """Declare a normal map, a texture with the components of normals, or a colour for all points.

    Without one, all normals are those of the surface.
    """

    def read_normals(value: Any) -> Any:
        import mitsuba as mi

        if isinstance(value, mi.Texture):
            return value
        if not (value is None or is_colour(value)):
            raise ValueError("a texture with three channels")
        colour = [0.5, 0.5, 1.0] if value is None else list(value)
        pixel = mi.Bitmap(np.array(colour, np.float32).reshape(1, 1, 3))
        return mi.load_dict({"type": "bitmap", "bitmap": pixel, "raw": True}, parallel=False)

    return Setting(None, None, meaning, read_normals, differentiable=True)


def declare_phase_function(meaning: str) -> Setting:
    """Declare a phase function, which is isotropic where the scene gives none."""

    def read_phase(value: Any) -> Any:
        import mitsuba as mi

        if value is None:
            return mi.load_dict({"type": "isotropic"}, parallel=False)
        if not isinstance(value, mi.PhaseFunction):
            raise ValueError("a phase function")
        return value

    return Setting(None, None, meaning, read_phase, differentiable=True)


def declare_volume(default: Any, meaning: str, coloured: bool = True, least: float = 0) -> Setting:
    """Declare a volume, such as Mitsuba's gridvolume, whose values are `least` or more.

    A number or a colour makes a constant volume. If not `coloured`, it has one channel.
    """

    def read_volume(value: Any) -> Any:
        import mitsuba as mi

        if isinstance(value, mi.Volume):
            require_volume(value, coloured, least)
            return value
        if coloured and is_colour(value):
            return make_coloured_volume(value)
        if not is_number(value):
            constant = "a number or a colour" if coloured else "or a number"
            raise ValueError(f"a volume, such as a gridvolume, {constant}")
        return make_constant_volume(_convert_to_number(value, (least, math.inf)))

    return Setting(default, None, meaning, read_volume, differentiable=True)


def read_settings(
    settings: Mapping[str, Setting], get: Callable[[str, Any], Any], owner: str
) -> dict[str, Any]:
    """Read the values of the declared `settings`, and return them by name.

    `get(name, default)` returns what the user has given, or else the default. Raises
    `BrdfkitError`, which names the `owner`, for a value that is not allowed.
    """
    values = {}
    for name, setting in settings.items():
        value = get(name, setting.default)
        try:
            values[name] = setting.read(value)
        except (TypeError, ValueError) as error:
            message = f"{owner}: {name} = {_shorten_for_message(value)} should be {error}."
            raise BrdfkitError(message) from error
    return values


def derive_plugin(base: Any, parameters: Mapping[str, Setting]) -> Any:
    """Derive a class from `base`, one of Mitsuba's, with declared `parameters` by name.

    Each parameter is an attribute of an instance; optimisers see the differentiable ones. A derived
    class that defines `parameters_changed` should call that of this class.
    """

    class Declared(base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            for name, value in read_settings(parameters, props.get, props.plugin_name()).items():
                setattr(self, name, value)

        def traverse(self, callback: MitsubaObject) -> None:
            import mitsuba as mi

            for name, setting in parameters.items():
                if setting.differentiable and getattr(self, name) is not None:
                    callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: Sequence[str] = ()) -> None:
            """Make changed numbers opaque again, or each new one would need a new kernel."""
            import drjit as dr

            for name, setting in parameters.items():
                value = getattr(self, name)
                if setting.differentiable and value is not None and dr.is_jit_v(value):
                    dr.make_opaque(value)

        def to_string(self) -> str:
            lines = [f"  {name} = {getattr(self, name)}" for name in parameters]
            return "\n".join([f"{type(self).__name__}[", *lines, "]"])

    return Declared


def _convert_to_number(value: Any, bounds: tuple[float, float]) -> float:
    """Return a property as a float; raise a ValueError if it is no number within `bounds`."""
    low, high = bounds
    if not (is_number(value) and low <= value <= high):
        raise ValueError(describe_range("a number", low, high))
    return float(value)


def _shorten_for_message(value: object) -> str:
    """Return a value as text in one line of at most 60 characters, for an error message."""
    return " ".join(str(value).split())[:60]
