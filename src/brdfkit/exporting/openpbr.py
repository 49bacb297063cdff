"""The model `openpbr` as MaterialX's node `open_pbr_surface`, and as renderers draw that."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.exporting.target import Held
from brdfkit.model import Model

COLOURS = "base_color", "fuzz_color"
ANISOTROPY = "specular_roughness_anisotropy"
FIXED = {"coat_ior": 1.6, "coat_darkening": 0.0}  # what the model has no parameters for
LAYERS = "below_highlight", "below_coat", "below_fuzz"  # methods: the light that a layer passes
CHANGE = "layers darken what lies below by the direction of the viewer alone"


def hold_openpbr(model: Model) -> Held | None:
    """Return what renderers draw of an `openpbr`; None for other models."""
    if model.type_name() != "openpbr":
        return None
    values = {name: getattr(model, name) for name in model.parameters}
    bare = values["base_metalness"] == 1 and not values["coat_weight"]
    bare = bare and not values.get("fuzz_weight")
    return Held(model, model) if bare else Held(_draw_by_viewer(model), model, (CHANGE,))


def _draw_by_viewer(model: Model) -> Model:
    """Return a model in which the light that a layer passes depends on the viewer alone.

    In `openpbr` that is the geometric mean for both directions, √(p_i p_o), so that p_o is what it
    says of the viewer's direction twice.
    """

    def take_viewer(name: str) -> Any:
        own = getattr(type(model), name)
        return lambda self, wi, wo: own(self, wo, wo)

    methods = {name: take_viewer(name) for name in LAYERS}
    methods["__module__"] = type(model).__module__  # by which models have their names
    drawn: Any = type(type(model).__name__, (type(model),), methods)
    return drawn(**{name: getattr(model, name) for name in model.parameters})


def to_inputs(model: Model) -> dict[str, Any]:
    """Return the values of the node's inputs by name: colours, and numbers.

    The model's parameters have the node's names. A negative anisotropy becomes a positive one, for
    a tangent that is turned by 90°.
    """
    values = {name: getattr(model, name) for name in model.parameters}
    colours = {n: np.broadcast_to(values[n], 3).tolist() for n in COLOURS if n in values}
    return values | colours | {ANISOTROPY: abs(values[ANISOTROPY])} | FIXED


def is_turned(model: Model) -> bool:
    """Return whether the highlight is wide along y, so that the tangent has to be turned."""
    return bool(getattr(model, ANISOTROPY) < 0)
