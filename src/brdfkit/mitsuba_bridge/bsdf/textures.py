"""The parameters of a model as textures: the base class of the model's BSDF plugin."""

import math

import drjit as dr
import numpy as np

from brdfkit.mitsuba_bridge.bsdf.base import define_frame
from brdfkit.mitsuba_bridge.bsdf.signed_sum import average_texture
from brdfkit.mitsuba_bridge.properties import conversions


def define_textured_frame(mi, model):
    """The base class of the BSDF of `model` in the current variant.

    It has a texture for every parameter in `textures`, by name, except for those that follow
    another one.
    """
    defaults = model()

    class TexturedFrame(define_frame(mi)):
        def __init__(self, props):
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

        def traverse(self, callback):
            for name, texture in self.textures.items():
                kind = mi.ParamFlags.Differentiable
                if not model.parameters[name].linear:
                    kind |= mi.ParamFlags.Discontinuous
                callback.put(name, texture, kind)

        def scale(self, name):
            """The factor of a texture's values: not 1 where a colour was normalised."""
            return self.scales.get(name, 1)

        def terms(self, si, active):
            """Weights and lobes at a surface point."""
            values = {}
            for name, texture in self.textures.items():
                parameter = model.parameters[name]
                value = (texture.eval if parameter.linear else texture.eval_1)(si, active)
                values[name] = clamp(value * self.scale(name), parameter)
            return [values[name] for name in model.weights()], model.bind(values).lobes()

        def means(self):
            """Means over the textures: shape parameters by name, and weights (lobes, channels)."""
            means = {}
            for name, texture in self.textures.items():
                mean = average_texture(texture, getattr(defaults, name)) * self.scale(name)
                means[name] = np.clip(mean, *model.parameters[name].bounds)
            weights = [means.pop(name) for name in model.weights()]
            return {name: m[0] for name, m in means.items()}, np.stack(
                np.broadcast_arrays(*weights)
            )

        def has_attribute(self, name, active=True):
            return super().has_attribute(self.texture_name(name), active)

        def eval_attribute(self, name, si, active=True):
            return self.attribute_by("eval", super().eval_attribute, name, si, active)

        def eval_attribute_1(self, name, si, active=True):
            return self.attribute_by("eval_1", super().eval_attribute_1, name, si, active)

        def eval_attribute_3(self, name, si, active=True):
            return self.attribute_by("eval_3", super().eval_attribute_3, name, si, active)

        def attribute_by(self, method, inherited, name, si, active):
            """The value of an attribute: of a parameter, by the `method` of its texture.

            Other attributes go to `inherited`, Mitsuba's own method. Parameters do not, because
            that method calls the plugin's method once more.
            """
            key = self.texture_name(name)
            if key not in self.textures:
                return inherited(name, si, active)
            return getattr(self.textures[key], method)(si, active) * self.scale(key)

        def texture_name(self, name):
            """The name of a parameter's texture: of the parameter that it follows, if it does."""
            follows = name in model.parameters and name not in self.textures
            return model.parameters[name].follows if follows else name

        def to_string(self):
            lines = [f"  {name} = {texture}" for name, texture in self.textures.items()]
            return "\n".join([f"{model.__name__}[", *lines, "]"])

    TexturedFrame.model = model
    return TexturedFrame


def clamp(value, parameter):
    """A texture's value within the bounds of the parameter: a texture may hold anything."""
    # Not dr.clip: on a bound it has half the derivative
    low, high = parameter.bounds
    held = value if low == -math.inf else dr.select(value < low, low, value)
    held = held if high == math.inf else dr.select(held > high, high, held)
    return type(value)(held)  # of a spectrum, select makes a plain array
