"""The one adapter from a model to a Mitsuba BSDF.

Written once for all models: textures for every parameter, one component per lobe (or per sampling,
where lobes share one), chosen by its weight and energy, and a share of cosine samples, which bounds
the weight of a sample where the BRDF itself is bounded.
"""

import functools
import math
import operator

import numpy as np

from brdfkit.geometry.quadrature import cosine_directions
from brdfkit.geometry.vectors import above_horizon
from brdfkit.host import properties
from brdfkit.host.signed_sum import tabulated, texture_mean
from brdfkit.model.lobes import Cosine, components_of

# Share of the samples that follow the cosine, whatever the lobes
COSINE_SHARE = 0.1
COSINE = Cosine()
# Directions over which the diffuse reflectance is the mean
FROM_ABOVE = cosine_directions(64)


def define(mi, model):
    """The class of `mi.BSDF` that evaluates and samples `model` in the current variant."""
    import drjit as dr

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

    def enabled(ctx, k):
        return ctx.is_enabled(kinds[k], k)

    def first_enabled(ctx):
        return next((k for k in range(len(kinds)) if enabled(ctx, k)), 0)

    def kind_of(component):
        kind = mi.UInt32(int(kinds[0]))
        for k, other in enumerate(kinds[1:], 1):
            kind = dr.select(component == k, int(other), kind)
        return kind

    def within(value, parameter):
        # A texture may hold anything. Not dr.clip: on a bound it has half the derivative
        low, high = parameter.bounds
        held = value if low == -math.inf else dr.select(value < low, low, value)
        held = held if high == math.inf else dr.select(held > high, high, held)
        return type(value)(held)  # of a spectrum, select makes a plain array

    class Plugin(mi.BSDF):
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
            # A sum of signed lobes is drawn by a table
            if signed:
                means = {}
                for name, texture in self.textures.items():
                    parameter = model.parameters[name]
                    mean = texture_mean(texture, getattr(defaults, name)) * self.scale(name)
                    mean = np.clip(mean, *parameter.bounds)
                    means[name] = mean if parameter.linear else mean[0]
                self.tables = {k: tabulated(model(**means), groups[k]) for k in signed}

        def sampling(self, k, lobes):
            """The way to draw component `k`."""
            return self.tables.get(k, lobes[groups[k][0]].sampling)

        def scale(self, name):
            """By what the texture of a colour is multiplied."""
            return self.scales.get(name, 1)

        def sample(self, ctx, si, sample1, sample2, active=True):
            wi, active = above_horizon(si.wi, active)
            weights, lobes = self.terms(si, active)
            shares = self.shares(ctx, wi, weights, lobes)

            # Choose a component, or the cosine, by sample1
            wo = COSINE.sample(wi, sample2)
            component = mi.UInt32(first_enabled(ctx))
            chosen_up_to = mi.Float(COSINE_SHARE)
            for k, share in enumerate(shares):
                if share is None:
                    continue
                hit = (sample1 >= chosen_up_to) & (sample1 < chosen_up_to + share)
                # what sample1 has not yet decided is as random as sample2
                u = mi.Point3f(sample2.x, sample2.y, (sample1 - chosen_up_to) / share)
                chosen_up_to += share
                wo = dr.select(hit, self.sampling(k, lobes).sample(wi, u), wo)
                component = dr.select(hit, k, component)

            # Directions are drawn without derivatives, and so is their density in the weight
            wo = dr.detach(wo)
            sample = dr.zeros(mi.BSDFSample3f)
            above_wo, active = above_horizon(wo, active)
            value, pdf = self.value_and_pdf(ctx, weights, lobes, shares, wi, above_wo)
            active &= pdf > 0
            sample.wo = wo
            sample.pdf = dr.select(active, pdf, 0)
            sample.eta = 1.0
            sample.sampled_component = component
            sample.sampled_type = kind_of(component)
            pdf = dr.select(active, pdf, 1)
            weight = dr.select(active, value / dr.detach(pdf), 0)
            return sample, mi.depolarizer(weight)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_pdf(self, ctx, si, wo, active=True):
            wi, active = above_horizon(si.wi, active)
            wo, active = above_horizon(wo, active)
            weights, lobes = self.terms(si, active)
            shares = self.shares(ctx, wi, weights, lobes)
            value, pdf = self.value_and_pdf(ctx, weights, lobes, shares, wi, wo)
            return mi.depolarizer(dr.select(active, value, 0)), dr.select(active, pdf, 0)

        def eval_diffuse_reflectance(self, si, active=True):
            """Albedo of the diffuse lobes seen along the normal, by quadrature."""
            weights, lobes = self.terms(si, active)
            diffuse = [i for i, lobe in enumerate(lobes) if lobe.diffuse]
            total = mi.UnpolarizedSpectrum(0)
            for direction in FROM_ABOVE:
                wo = mi.Vector3f(*map(float, direction))
                total += dr.pi * self.value(weights, lobes, diffuse, mi.Vector3f(0, 0, 1), wo)
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

        def terms(self, si, active):
            """Weights and lobes at a surface point."""
            values = {}
            for name, texture in self.textures.items():
                parameter = model.parameters[name]
                value = (texture.eval if parameter.linear else texture.eval_1)(si, active)
                values[name] = within(value * self.scale(name), parameter)
            return [values[name] for name in model.weights()], model.bind(values).lobes()

        def shares(self, ctx, wi, weights, lobes):
            """Probability of each component, None where the context leaves it out."""
            energies = []
            for k, group in enumerate(groups):
                energy = sum(dr.mean(dr.abs(weights[i])) * lobes[i].energy(wi) for i in group)
                energies.append(dr.detach(energy) + 1e-8 if enabled(ctx, k) else None)
            total = sum(e for e in energies if e is not None)
            return [None if e is None else (1 - COSINE_SHARE) * e / total for e in energies]

        def value_and_pdf(self, ctx, weights, lobes, shares, wi, wo):
            """BRDF times cosine of the enabled components, and the density of `sample`."""
            none = all(share is None for share in shares)
            pdf = mi.Float(0 if none else COSINE_SHARE * COSINE.pdf(wi, wo))
            for k, share in enumerate(shares):
                if share is not None:
                    pdf += share * self.sampling(k, lobes).pdf(wi, wo)
            enabled = [i for g, s in zip(groups, shares, strict=True) if s is not None for i in g]
            return self.value(weights, lobes, enabled, wi, wo) * wo.z, pdf

        def value(self, weights, lobes, chosen, wi, wo):
            """BRDF, the sum of the `chosen` lobes."""
            value = mi.UnpolarizedSpectrum(0)
            for i in chosen:
                value += weights[i] * lobes[i].eval(wi, wo)
                if lobes[i].quadratic is not None:
                    value += weights[i] * weights[i] * lobes[i].quadratic(wi, wo)
            return dr.maximum(value, 0) if model.signed() else value

        def to_string(self):
            lines = [f"  {name} = {texture}" for name, texture in self.textures.items()]
            return "\n".join([f"{model.__name__}[", *lines, "]"])

    return Plugin
