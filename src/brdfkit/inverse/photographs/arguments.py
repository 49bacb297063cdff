"""Checks the arguments of `svbrdf` and converts them to the objects that its search needs."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_dictionary, to_number, to_whole_number
from brdfkit.core.array_types import IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.capture import SMALLEST_MAP, Capture
from brdfkit.inverse.photographs.capture.load_photographs import load_photographs
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.maps import find_width_pair
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters
from brdfkit.model import labels

DEFAULT_LONGEST_SIDE = 512  # largest default number of texels along the maps' longer side
# smallest `smoothness` allowed; smoother maps would need more steps than a search takes
SMALLEST_SMOOTHNESS = 0.003


def check_variant() -> None:
    """Raise `BrdfkitError` unless Mitsuba's variant renders RGB and LLVM computes derivatives."""
    variant = use_variant()
    if not variant.endswith("_rgb"):
        raise BrdfkitError(
            f"svbrdf: the variant {variant} makes no pictures in RGB; set llvm_ad_rgb."
        )
    if not double_precision.has_derivatives():
        raise BrdfkitError("svbrdf: it needs LLVM, for derivatives; see the README.")


def to_capture(value: object, linearise: str | float | None) -> tuple[str, Capture | ObjectCapture]:
    """Return a name and the photographs, from their folder or as a `Capture` or `ObjectCapture`.

    `linearise` says how the numbers of the photographs in a folder are coded.
    """
    if isinstance(value, ObjectCapture):
        return value.name, value
    if isinstance(value, Capture):
        return "sample", value
    if not isinstance(value, str | PathLike):
        raise BrdfkitError(f"capture: a {type(value).__name__} is neither a folder nor a Capture.")
    return Path(value).resolve().name, load_photographs(Path(value), linearise)


def choose_hidden_photographs(count: int, hold_out: int | None) -> IntArray:
    """Return the indices of the photographs that are held out: every `hold_out`-th of `count`."""
    if hold_out is None:
        return np.zeros(0, int)
    step = to_whole_number("hold_out", hold_out, 2)
    hidden = np.arange(count)[1::step]
    if not len(hidden):
        raise BrdfkitError(f"hold_out: of {count} photographs none can be held out; leave it out.")
    return hidden


def to_texel_parameters(
    label: str, anisotropic: bool, fixed: Mapping[str, float] | None
) -> TexelParameters:
    """Return which numbers are searched for each texel of the maps, for a model's label.

    `fixed` holds shape parameters with one value everywhere. Raises `BrdfkitError` for unknown
    parameters, values beyond their bounds, and a model whose weights may be negative.
    """
    model = labels.model(label)
    if model.has_signed_weights():
        raise BrdfkitError(f"{label}: its weights may be below 0; choose another model, as ggx.")
    if model().fixed_lobes():
        raise BrdfkitError(f"{label}: it has lobes without a weight; choose another model, as ggx.")
    shapes, fixed = model.shapes(anisotropic), to_dictionary("fixed", fixed)
    for name in fixed:
        if name not in shapes:
            model.parameter(name)
            raise BrdfkitError(
                f"{label}: {name} is not searched; fixed can be {join_words(shapes)}."
            )
    defaults = model().values
    # In a sum of models each one has its own f0, named such as ggx_1_f0
    held: dict[str, Any] = {
        name: defaults[name] for name in shapes if name == "f0" or name.endswith("_f0")
    }
    held |= {name: to_number(name, value) for name, value in fixed.items()}
    model(**held)  # raises an error for values beyond the bounds
    names = tuple(name for name in shapes if name not in held)
    return TexelParameters(model, names, held, find_width_pair(model, names))


def to_smoothness(value: float | None) -> float | None:
    """Return the smoothness as a checked number, or None if the search has to choose it."""
    return None if value is None else to_number("smoothness", value, least=SMALLEST_SMOOTHNESS)


def choose_map_shape(capture: Capture, resolution: int | None) -> tuple[int, int]:
    """Return the shape (height, width) of the maps, whose longer side is `resolution` texels."""
    if resolution is None:
        return capture.default_shape(DEFAULT_LONGEST_SIDE)
    longer = to_whole_number("resolution", resolution, SMALLEST_MAP)
    width, height = capture.size
    scale = longer / max(width, height)
    return max(SMALLEST_MAP, round(height * scale)), max(SMALLEST_MAP, round(width * scale))
