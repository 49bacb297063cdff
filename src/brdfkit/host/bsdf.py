"""The one adapter from a model to a Mitsuba BSDF.

Written once for all models: textures for every parameter, one component per lobe (or per sampling,
where lobes share one), chosen by its weight and energy.
"""

import functools
import math
import operator

import drjit as dr
import numpy as np

from brdfkit.geometry.quadrature import cosine_directions
from brdfkit.host import frame, properties
from brdfkit.host.bsdf_point import Point
from brdfkit.host.signed_sum import tabulated, texture_mean
from brdfkit.model.lobes import components_of

# Directions over which the diffuse reflectance is the mean
FROM_ABOVE = cosine_directions(64)


def define(mi, model):
    """The class of `mi.BSDF` that evaluates and samples `model` in the current variant."""
    flags = mi.BSDFFlags
    defaults = model()
    groups = components_of(defaults.lobes())
    kinds = [
        flags.DiffuseReflection if lobe.diffuse else flags.GlossyReflection
        for lobe in (defaults.lobes()[group[0]] for group in groups)
    ]
    linear = [model.parameters[name] for name in model.weights()]
    signed = [k for k, group in enumerate(groups) if any(linear[i].bounds[0] < 0 for i in group)]
    anisotropic = flags.Anisotropic if model.anisotropic() else flags.Empty
    turning = [k for k, kind in enumerate(kinds) if kind == flags.GlossyReflection or k in signed]
    components = [
        kind | flags.FrontSide | (anisotropic if k in turning else flags.Empty)
        for k, kind in enumerate(kinds)
    ]

    class Plugin(frame.frame(mi)):
        def __init__(self, props):
            super().__init__(props)
            self.textures = {}
            self.scales = {}
            for name, parameter in model.parameters.items():
                if parameter.follows and name not in props:
                    continue
                properties.require_within_bounds(props, model, name)
                if mi.is_spectral and properties.is_colour(props.get(name, None)):
                    self.scales[name] = properties.fit_for_a_spectrum(props, model, name)
                self.textures[name] = props.get_unbounded_texture(name, getattr(defaults, name))
            self.tables = {}
            self.parameters_changed()
            varying = any(t.is_spatially_varying() for t in self.textures.values())
            extra = flags.SpatiallyVarying if varying else flags.Empty
            self.m_components = [component | extra for component in components]
            self.m_flags = functools.reduce(operator.or_, self.m_components)

        def traverse(self, callback):
            for name, texture in self.textures.items():
                kind = mi.ParamFlags.Differentiable
                if not model.parameters[name].linear:
                    kind |= mi.ParamFlags.Discontinuous
                callback.put(name, texture, kind)

        def parameters_changed(self, keys=()):
            if signed:  # a sum of signed lobes is drawn by a table
                shapes, weights = self.means()
                self.tables = {k: tabulated(model(**shapes), weights, groups[k]) for k in signed}

        def means(self):
            """Of the textures: shape parameters by name, and weights (lobes, channels)."""
            means = {}
            for name, texture in self.textures.items():
                mean = texture_mean(texture, getattr(defaults, name)) * self.scale(name)
                means[name] = np.clip(mean, *model.parameters[name].bounds)
            weights = [means.pop(name) for name in model.weights()]
            return {name: m[0] for name, m in means.items()}, np.stack(
                np.broadcast_arrays(*weights)
            )

        def scale(self, name):
            """By what the texture of a colour is multiplied."""
            return self.scales.get(name, 1)

        def at(self, ctx, si, wi, active):
            weights, lobes = self.terms(si, active)
            samplings = [
                self.tables.get(k, lobes[group[0]].sampling) for k, group in enumerate(groups)
            ]
            enabled = [ctx.is_enabled(kind, k) for k, kind in enumerate(kinds)]
            return Point(mi, wi, weights, lobes, model.signed(), groups, samplings, enabled)

        def terms(self, si, active):
            """Weights and lobes at a surface point."""
            values = {}
            for name, texture in self.textures.items():
                parameter = model.parameters[name]
                value = (texture.eval if parameter.linear else texture.eval_1)(si, active)
                values[name] = within(value * self.scale(name), parameter)
            return [values[name] for name in model.weights()], model.bind(values).lobes()

        def eval_diffuse_reflectance(self, si, active=True):
            """Albedo of the diffuse lobes seen along the normal, by quadrature."""
            normal = self.at(mi.BSDFContext(), si, mi.Vector3f(0, 0, 1), active)
            diffuse = [i for i, lobe in enumerate(normal.lobes) if lobe.diffuse]
            total = mi.UnpolarizedSpectrum(0)
            for direction in FROM_ABOVE:
                total += dr.pi * normal.sum_of(diffuse, mi.Vector3f(*map(float, direction)))
            return mi.Spectrum(dr.select(active, total / len(FROM_ABOVE), 0))

        def has_attribute(self, name, active=True):
            return super().has_attribute(self.attribute(name), active)

        def eval_attribute(self, name, si, active=True):
            return self.attribute_by("eval", super().eval_attribute, name, si, active)

        def eval_attribute_1(self, name, si, active=True):
            return self.attribute_by("eval_1", super().eval_attribute_1, name, si, active)

        def eval_attribute_3(self, name, si, active=True):
            return self.attribute_by("eval_3", super().eval_attribute_3, name, si, active)

        def attribute_by(self, method, inherited, name, si, active):
            """A parameter by a method of its texture; Mitsuba's own calls this one again, and is
            only for what is no parameter."""
            key = self.attribute(name)
            if key not in self.textures:
                return inherited(name, si, active)
            return getattr(self.textures[key], method)(si, active) * self.scale(key)

        def attribute(self, name):
            """The name of the texture behind a parameter: that of another one which it follows."""
            follows = name in model.parameters and name not in self.textures
            return model.parameters[name].follows if follows else name

        def to_string(self):
            lines = [f"  {name} = {texture}" for name, texture in self.textures.items()]
            return "\n".join([f"{model.__name__}[", *lines, "]"])

    return Plugin


def within(value, parameter):
    """A texture's value within the bounds: a texture may hold anything."""
    # Not dr.clip: on a bound it has half the derivative
    low, high = parameter.bounds
    held = value if low == -math.inf else dr.select(value < low, low, value)
    held = held if high == math.inf else dr.select(held > high, high, held)
    return type(value)(held)  # of a spectrum, select makes a plain array
