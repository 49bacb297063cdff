"""Checks the arguments of `svbrdf` and converts them to the objects that its search needs."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from brdfkit.core.arguments import to_dictionary, to_number, to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.capture import SMALLEST_MAP, Capture
from brdfkit.inverse.photographs.capture.capture_file import load_capture
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


def to_capture(value: object, accept_8_bit: bool) -> tuple[str, Capture]:
    """Return a sample's name and its `Capture`, from the folder of photographs or a `Capture`."""
    if isinstance(value, Capture):
        return "sample", value
    if not isinstance(value, str | PathLike):
        raise BrdfkitError(f"capture: a {type(value).__name__} is neither a folder nor a Capture.")
    return Path(value).resolve().name, load_capture(Path(value), accept_8_bit)


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
