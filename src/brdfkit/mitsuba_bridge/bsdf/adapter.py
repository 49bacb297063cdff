"""Adapts any `Model` to a BSDF of Mitsuba.

The BSDF has a texture for every parameter. Each lobe, a term of the model's sum or a part of one,
is a component of the BSDF, which is drawn in proportion to its weight and energy. Lobes whose
directions are drawn by the same object are one component.
"""

import functools
import operator
from collections.abc import Sequence
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitColour, JitMask, JitVector, MitsubaModule, MitsubaObject
from brdfkit.core.geometry.quadrature import make_cosine_directions
from brdfkit.core.jit import double_precision
from brdfkit.mitsuba_bridge.bsdf.signed_sum import tabulate_lobe_sum
from brdfkit.mitsuba_bridge.bsdf.surface_response import Point
from brdfkit.mitsuba_bridge.bsdf.textures import define_textured_bsdf
from brdfkit.model import Model
from brdfkit.model.lobes import group_components

# Outgoing directions of the quadrature in `eval_diffuse_reflectance`
DIRECTIONS = make_cosine_directions(64)


def define_bsdf(mi: MitsubaModule, model: type[Model]) -> Any:
    """Define the class of `mi.BSDF` that evaluates and samples a model in the current variant."""
    groups = group_components([lobe for _, lobe in model().drawn_lobes()])
    signed = find_signed_components(model, groups)
    kinds = find_component_kinds(mi, model, groups)
    components = find_component_flags(mi, model, kinds, signed)

    Base: Any = define_textured_bsdf(mi, model)

    class Plugin(Base):
        has_constant_diffuse_part = has_constant_diffuse_lobes(model)

        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.tables: dict[int, Any] = {}
            self.parameters_changed()
            varying = any(t.is_spatially_varying() for t in self.textures.values())
            extra = mi.BSDFFlags.SpatiallyVarying if varying else mi.BSDFFlags.Empty
            self.m_components = [component | extra for component in components]
            self.m_flags = functools.reduce(operator.or_, self.m_components)

        def parameters_changed(self, keys: Sequence[str] = ()) -> None:
            if signed:  # lobes with signed weights are sampled by a table
                shapes, weights = self.average_textures()
                averaged = model(**shapes)
                numbers: list[Any] = [number for number, _ in averaged.drawn_lobes()]
                self.tables = {
                    k: tabulate_lobe_sum(averaged, weights, [numbers[i] for i in groups[k]])
                    for k in signed
                }

        def make_response(
            self, ctx: MitsubaObject, si: MitsubaObject, wi: JitVector, active: JitMask
        ) -> Point:
            weights, lobes = self.bind_lobes(si, active)
            samplings = [
                self.tables.get(k, lobes[group[0]].sampling) for k, group in enumerate(groups)
            ]
            enabled = [ctx.is_enabled(kind, k) for k, kind in enumerate(kinds)]
            return Point(
                mi, wi, weights, lobes, model.has_signed_weights(), groups, samplings, enabled
            )

        def eval_diffuse_reflectance(self, si: MitsubaObject, active: JitMask = True) -> JitColour:
            """Compute the albedo of the diffuse lobes at normal incidence by quadrature."""
            normal = self.make_response(mi.BSDFContext(), si, mi.Vector3f(0, 0, 1), active)
            diffuse = [i for i, lobe in enumerate(normal.lobes) if lobe.diffuse]
            total = mi.UnpolarizedSpectrum(0)
            for direction in DIRECTIONS:
                total += dr.pi * normal.evaluate_lobes(diffuse, mi.Vector3f(*map(float, direction)))
            return mi.Spectrum(dr.select(active, total / len(DIRECTIONS), 0))

    return Plugin


def has_constant_diffuse_lobes(model: type[Model]) -> bool:
    """Return whether a model has diffuse lobes, and all of them are constant, as Lambert's is.

    A sum that is clamped at 0 has no lobes of its own.
    """
    up = double_precision.to_vector(np.array([[0.0, 0.0, 1.0]]))
    values = [lobe.eval(up, up) for _, lobe in model().drawn_lobes() if lobe.diffuse]
    constant = bool(values) and all(isinstance(value, float) for value in values)
    return constant and not model.has_signed_weights()


def find_signed_components(model: type[Model], groups: list[list[int]]) -> list[int]:
    """Return the components, as indices of `groups` of lobes, with weights that may be negative."""
    lowest = [model.parameters[name].bounds[0] for name in model.weights()]
    signed = [k is not None and lowest[k] < 0 for k, _ in model().drawn_lobes()]
    return [k for k, group in enumerate(groups) if any(signed[i] for i in group)]


def find_component_kinds(
    mi: MitsubaModule, model: type[Model], groups: list[list[int]]
) -> list[Any]:
    """Return Mitsuba's flag of each component, diffuse or glossy, by the group's first lobe."""
    flags, lobes = mi.BSDFFlags, [lobe for _, lobe in model().drawn_lobes()]
    return [
        flags.DiffuseReflection if lobes[group[0]].diffuse else flags.GlossyReflection
        for group in groups
    ]


def find_component_flags(
    mi: MitsubaModule, model: type[Model], kinds: list[Any], signed: list[int]
) -> list[Any]:
    """Return all flags of each component except for `SpatiallyVarying`.

    In an anisotropic model, components are anisotropic if they are glossy or in `signed`, the
    indices of those whose weights may be negative.
    """
    flags = mi.BSDFFlags
    anisotropic = flags.Anisotropic if model.is_anisotropic() else flags.Empty
    turning = [k for k, kind in enumerate(kinds) if kind == flags.GlossyReflection or k in signed]
    return [
        kind | flags.FrontSide | (anisotropic if k in turning else flags.Empty)
        for k, kind in enumerate(kinds)
    ]
