"""The one adapter from a model to a Mitsuba BSDF.

Written once for all models: textures for every parameter, one component per lobe (or per sampling,
where lobes share one), chosen by its weight and energy, and a share of cosine samples, which bounds
the weight of a sample where the BRDF itself is bounded.
"""

import functools
import operator

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.lobes import Cosine
from brdfkit.vectors import above_horizon

# Share of the samples that follow the cosine, whatever the lobes
COSINE_SHARE = 0.1
COSINE = Cosine()


def scene_dict(model):
    """The dictionary for `mitsuba.load_dict` of a model with values."""
    entries = {"type": model.type_name(), **model.chosen()}
    for name, value in model.free_values.items():
        entries[name] = _rgb(value) if isinstance(value, tuple) else value
    return entries


def _rgb(value):
    value = value * 3 if len(value) == 1 else value
    return {"type": "rgb", "value": list(value)}


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
    anisotropic = flags.Anisotropic if model.anisotropic() else flags.Empty
    components = [
        kind | flags.FrontSide | (anisotropic if kind == flags.GlossyReflection else flags.Empty)
        for kind in kinds
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
        return dr.select(value < low, low, dr.select(value > high, high, value))

    class Plugin(mi.BSDF):
        def __init__(self, props):
            super().__init__(props)
            self.textures = {}
            self.scales = {}
            for name, parameter in model.parameters.items():
                if parameter.follows and name not in props:
                    continue
                _require_within_bounds(props, model, name)
                if mi.is_spectral and _is_colour(props.get(name, None)):
                    self.scales[name] = _fit_for_a_spectrum(props, model, name)
                self.textures[name] = props.get_unbounded_texture(name, getattr(defaults, name))
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

        def sample(self, ctx, si, sample1, sample2, active=True):
            wi, active = above_horizon(si.wi, active)
            weights, lobes = self.terms(si, active)
            shares = self.shares(ctx, wi, weights, lobes)

            # Choose a component, or the cosine, by sample1
            wo = COSINE.sample(wi, sample2)
            component = mi.UInt32(first_enabled(ctx))
            chosen_up_to = mi.Float(COSINE_SHARE)
            for k, (group, share) in enumerate(zip(groups, shares, strict=True)):
                if share is None:
                    continue
                hit = (sample1 >= chosen_up_to) & (sample1 < chosen_up_to + share)
                chosen_up_to += share
                wo = dr.select(hit, lobes[group[0]].sampling.sample(wi, sample2), wo)
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
            return sample, dr.select(active, value / dr.detach(pdf), 0)

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
            return dr.select(active, value, 0), dr.select(active, pdf, 0)

        def eval_diffuse_reflectance(self, si, active=True):
            weights, lobes = self.terms(si, active)
            normal = mi.Vector3f(0, 0, 1)
            diffuse = [
                weight * lobe.energy(normal)
                for weight, lobe in zip(weights, lobes, strict=True)
                if lobe.diffuse
            ]
            return sum(diffuse, mi.Spectrum(0))

        def terms(self, si, active):
            """Weights and lobes at a surface point."""
            values = {}
            for name, texture in self.textures.items():
                if model.parameters[name].linear:
                    values[name] = texture.eval(si, active) * self.scales.get(name, 1)
                else:
                    values[name] = within(texture.eval_1(si, active), model.parameters[name])
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
            value = mi.Spectrum(0)
            none = all(share is None for share in shares)
            pdf = mi.Float(0 if none else COSINE_SHARE * COSINE.pdf(wi, wo))
            for group, share in zip(groups, shares, strict=True):
                if share is None:
                    continue
                pdf += share * lobes[group[0]].sampling.pdf(wi, wo)
                for i in group:
                    value += weights[i] * lobes[i].eval(wi, wo)
                    if lobes[i].quadratic is not None:
                        value += weights[i] * weights[i] * lobes[i].quadratic(wi, wo)
            if model.signed():
                value = dr.maximum(value, 0)
            return value * wo.z, pdf

        def to_string(self):
            lines = [f"  {name} = {texture}" for name, texture in self.textures.items()]
            return "\n".join([f"{model.__name__}[", *lines, "]"])

    return Plugin


def components_of(lobes):
    """Indices of the lobes of each component: lobes that share a sampling are one."""
    groups = {}
    for index, lobe in enumerate(lobes):
        groups.setdefault(id(lobe.sampling), []).append(index)
    return list(groups.values())


def _require_within_bounds(props, model, name):
    """An error for a constant parameter out of bounds; textures are taken as they are."""
    value = props.get(name, None)
    if isinstance(value, float | int) or _is_colour(value):
        problem = model.parameters[name].problem_with(np.array(value, float))
        if problem:
            raise BrdfkitError(f"{model.type_name()}: {name} = {problem}.")


def _fit_for_a_spectrum(props, model, name):
    """Bring a colour to 0..1, beyond which Mitsuba clips its spectrum without a word; the scale."""
    value = props[name]
    if min(value) < 0:
        raise BrdfkitError(
            f"{model.type_name()}: {name} is a colour with a value below 0, which no spectrum "
            "holds; use an rgb or mono variant of Mitsuba."
        )
    scale = 2 * max(value) if max(value) > 1 else 1
    props[name] = value / scale
    return scale


def _is_colour(value):
    return type(value).__name__.endswith("Color3d")
