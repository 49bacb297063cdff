"""The base class of a model's BSDF plugin, which holds the parameters of the model as textures."""

import math
from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import (
    AnyArray,
    JitColour,
    JitFloat,
    JitMask,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.mitsuba_bridge.bsdf.base import define_base_bsdf
from brdfkit.mitsuba_bridge.bsdf.signed_sum import average_texture
from brdfkit.mitsuba_bridge.properties import conversions
from brdfkit.model import Model, Parameter
from brdfkit.model.lobes import Lobe


def define_textured_bsdf(mi: MitsubaModule, model: type[Model]) -> Any:
    """Define the base class of the BSDF of a model in the current variant.

    Its `textures` hold a texture for every parameter, by name, except for parameters that follow
    another one.
    """
    defaults = model()

    Base: Any = define_base_bsdf(mi)

    class TexturedBsdf(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.textures = {}
            self.scales = {}
            for name, parameter in model.parameters.items():
                if parameter.follows and name not in props:
                    continue
                conversions.require_within_bounds(props, model, name)
                if mi.is_spectral and conversions.is_colour(props.get(name, None)):
                    self.scales[name] = conversions.normalise_colour(props, model, name)
                self.textures[name] = props.get_unbounded_texture(name, getattr(defaults, name))

        def traverse(self, callback: MitsubaObject) -> None:
            for name, texture in self.textures.items():
                kind = mi.ParamFlags.Differentiable
                if not model.parameters[name].linear:
                    kind |= mi.ParamFlags.Discontinuous
                callback.put(name, texture, kind)

        def texture_scale(self, name: str) -> float:
            """Return the number by which `normalise_colour` divided a colour texture, or 1."""
            return self.scales.get(name, 1)

        def bind_lobes(
            self, si: MitsubaObject, active: JitMask
        ) -> tuple[list[Any], tuple[Lobe, ...]]:
            """Return the lobes that are drawn, and their weights, at a point of a surface."""
            values = {}
            for name, texture in self.textures.items():
                parameter = model.parameters[name]
                value = (texture.eval if parameter.linear else texture.eval_1)(si, active)
                values[name] = clamp_to_bounds(value * self.texture_scale(name), parameter)
            weights, one = [values[name] for name in model.weights()], mi.UnpolarizedSpectrum(1)
            drawn = model.bind(values).drawn_lobes()
            return [one if k is None else weights[k] for k, _ in drawn], tuple(x for _, x in drawn)

        def average_textures(self) -> tuple[dict[str, Any], AnyArray]:
            """Return the textures' means: shape parameters by name, weights (lobes, channels)."""
            means = {}
            for name, texture in self.textures.items():
                mean = average_texture(texture, getattr(defaults, name)) * self.texture_scale(name)
                means[name] = np.clip(mean, *model.parameters[name].bounds)
            weights = [means.pop(name) for name in model.weights()]
            return {name: m[0] for name, m in means.items()}, np.stack(
                np.broadcast_arrays(*weights)
            )

        def has_attribute(self, name: str, active: JitMask = True) -> JitMask:
            return super().has_attribute(self.find_texture_name(name), active)

        def eval_attribute(self, name: str, si: MitsubaObject, active: JitMask = True) -> JitColour:
            return self.eval_texture_attribute("eval", super().eval_attribute, name, si, active)

        def eval_attribute_1(
            self, name: str, si: MitsubaObject, active: JitMask = True
        ) -> JitFloat:
            return self.eval_texture_attribute("eval_1", super().eval_attribute_1, name, si, active)

        def eval_attribute_3(
            self, name: str, si: MitsubaObject, active: JitMask = True
        ) -> JitColour:
            return self.eval_texture_attribute("eval_3", super().eval_attribute_3, name, si, active)

        def eval_texture_attribute(
            self,
            method: str,
            inherited: Callable[..., Any],
            name: str,
            si: MitsubaObject,
            active: JitMask,
        ) -> Any:
            """Return the value of a surface's attribute, which may be a parameter, by its `name`.

            A parameter is evaluated by the `method` of its texture, any other attribute by
            `inherited`, Mitsuba's own method, which would call the plugin again for a parameter.
            """
            key = self.find_texture_name(name)
            if key not in self.textures:
                return inherited(name, si, active)
            return getattr(self.textures[key], method)(si, active) * self.texture_scale(key)

        def find_texture_name(self, name: str) -> str | None:
            """Return the name of a parameter's texture, or of the parameter that it follows."""
            follows = name in model.parameters and name not in self.textures
            return model.parameters[name].follows if follows else name

        def to_string(self) -> str:
            lines = [f"  {name} = {texture}" for name, texture in self.textures.items()]
            return "\n".join([f"{model.__name__}[", *lines, "]"])

    TexturedBsdf.model = model
    return TexturedBsdf


def clamp_to_bounds(value: Any, parameter: Parameter) -> Any:
    """Clamp the value of a texture, which may hold anything, to the bounds of the parameter."""
    # Not by dr.clip, which halves the derivative of a value that lies on a bound
    low, high = parameter.bounds
    clamped = value if low == -math.inf else dr.select(value < low, low, value)
    clamped = clamped if high == math.inf else dr.select(clamped > high, high, clamped)
    return type(value)(clamped)  # dr.select turns a spectrum into a plain array
