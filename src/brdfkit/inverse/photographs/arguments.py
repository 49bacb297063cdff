"""What a caller of `svbrdf` asks for, checked: each error is one sentence."""

from os import PathLike
from pathlib import Path

from brdfkit.core.arguments import to_dictionary, to_number, to_positive, to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.capture_file import load_capture
from brdfkit.inverse.photographs.maps.maps import pair_of
from brdfkit.inverse.photographs.maps.texel_parameters import Numbers
from brdfkit.model import labels

MOST = 512  # texels along a side, by default
SMOOTHEST = 0.003  # below it the steps of a search end before the maps are as smooth as asked for


def require_variant():
    """Raise `BrdfkitError` where Mitsuba's pictures have no RGB, or nothing has derivatives."""
    variant = use_variant()
    if not variant.endswith("_rgb"):
        raise BrdfkitError(
            f"svbrdf: the variant {variant} makes no pictures in RGB; set llvm_ad_rgb."
        )
    if not double_precision.has_derivatives():
        raise BrdfkitError("svbrdf: it needs LLVM, for derivatives; see the README.")


def to_capture(given, accept_8_bit):
    """(name, `Capture`) of a folder or of what such a folder holds."""
    if isinstance(given, Capture):
        return "sample", given
    if not isinstance(given, str | PathLike):
        raise BrdfkitError(f"capture: a {type(given).__name__} is neither a folder nor a Capture.")
    return Path(given).resolve().name, load_capture(given, accept_8_bit)


def to_numbers(label, anisotropic, fixed):
    """The `Numbers` of a model's label.

    Raises `BrdfkitError` for parameters that are none, and for a model with signed weights.
    """
    model = labels.model(label)
    if model.signed():
        raise BrdfkitError(f"{label}: its weights may be below 0; choose another model, as ggx.")
    shapes, fixed = model.shapes(anisotropic), to_dictionary("fixed", fixed)
    for name in fixed:
        if name not in shapes:
            model.parameter(name)
            raise BrdfkitError(
                f"{label}: {name} is not searched; fixed can be {join_words(shapes)}."
            )
    usual = model().values
    # also those of the parts of a sum, as ggx_1_f0
    held = {name: usual[name] for name in shapes if name == "f0" or name.endswith("_f0")}
    held |= {name: to_number(name, value) for name, value in fixed.items()}
    model(**held)  # raises for values beyond the bounds
    names = tuple(name for name in shapes if name not in held)
    return Numbers(model, names, held, pair_of(model, names))


def to_smoothness(given):
    """The smoothness, or None for one that is chosen."""
    if given is not None and to_positive("smoothness", given) < SMOOTHEST:
        raise BrdfkitError(f"smoothness = {given:g} should be at least {SMOOTHEST}.")
    return given


def to_shape(capture, resolution):
    """(height, width) of the maps."""
    if resolution is None:
        return capture.usual_shape(MOST)
    longer = to_whole_number("resolution", resolution, 4)
    width, height = capture.size
    scale = longer / max(width, height)
    return max(4, round(height * scale)), max(4, round(width * scale))
