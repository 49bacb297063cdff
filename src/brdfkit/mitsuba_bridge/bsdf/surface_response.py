"""A model's BSDF at a point of a surface for light from `wi`: its sampling, density and value."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitInt, JitVector
from brdfkit.mitsuba_bridge.arrays import BELOW_ONE
from brdfkit.mitsuba_bridge.bsdf import base
from brdfkit.model.lobes import Lobe


@dataclass(frozen=True, eq=False)
class Point:
    """The lobes of a model with the values of its parameters at a point, for light from `wi`.

    `mi` is Mitsuba. `weights` has one weight for each of the `lobes`; `signed` says whether the sum
    is clamped at 0. `groups` are the indices of each component's lobes, `samplings` the `Sampling`
    of each component, and `enabled` says whether the context enables the component.
    """

    mi: Any
    wi: Any
    weights: list[Any]
    lobes: tuple[Lobe, ...]
    signed: bool
    groups: list[list[int]]
    samplings: list[Any]
    enabled: list[bool]

    @cached_property
    def shares(self) -> list[Any]:
        """The probability of drawing each component, from its energy; None if it is not enabled."""
        energies = []
        for group, enabled in zip(self.groups, self.enabled, strict=True):
            parts = (
                dr.mean(dr.abs(self.weights[i])) * self.lobes[i].energy(self.wi) for i in group
            )
            energies.append(dr.detach(sum(parts)) + 1e-8 if enabled else None)
        total = sum(e for e in energies if e is not None)
        share = 1 - base.COSINE_SHARE
        return [None if e is None else share * e / total for e in energies]

    def draw_direction(self, sample1: JitFloat, sample2: JitVector) -> tuple[JitVector, JitInt]:
        """Draw an outgoing direction with the density of the cosine, or of a component of the BSDF.

        Returns the direction and the component, which is the first enabled one for the cosine.
        """
        wo = base.COSINE.sample(self.wi, sample2)
        first = next((k for k, enabled in enumerate(self.enabled) if enabled), 0)
        component = self.mi.UInt32(first)
        chosen_up_to = self.mi.Float(base.COSINE_SHARE)
        for k, share in enumerate(self.shares):
            if share is None:
                continue
            hit = (sample1 >= chosen_up_to) & (sample1 < chosen_up_to + share)
            # What is left of sample1 after the choice is a third uniform random number. It is used
            # only where this component was chosen, but must stay in [0, 1) elsewhere, too
            left = dr.clip((sample1 - chosen_up_to) / share, 0, BELOW_ONE)
            u = self.mi.Point3f(sample2.x, sample2.y, left)
            chosen_up_to += share
            wo = dr.select(hit, self.samplings[k].sample(self.wi, u), wo)
            component = dr.select(hit, k, component)
        return wo, component

    def pdf(self, wo: JitVector) -> JitFloat:
        """Return the density of `draw_direction` per solid angle."""
        cosine = base.COSINE_SHARE * base.COSINE.pdf(self.wi, wo)
        pdf = self.mi.Float(cosine if any(self.enabled) else 0)
        for share, sampling in zip(self.shares, self.samplings, strict=True):
            if share is not None:
                pdf += share * sampling.pdf(self.wi, wo)
        return pdf

    def evaluate_brdf(self, wo: JitVector) -> JitColour:
        """Return the BRDF [sr⁻¹] of the enabled components."""
        groups = zip(self.groups, self.enabled, strict=True)
        return self.evaluate_lobes([i for group, enabled in groups if enabled for i in group], wo)

    def evaluate_lobes(self, chosen: list[int], wo: JitVector) -> JitColour:
        """Return the BRDF [sr⁻¹] of the lobes with the indices `chosen`: Σ weight times lobe."""
        value = self.mi.UnpolarizedSpectrum(0)
        for i in chosen:
            weight, lobe = self.weights[i], self.lobes[i]
            value += weight * lobe.eval(self.wi, wo)
            if lobe.quadratic is not None:
                value += weight * weight * lobe.quadratic(self.wi, wo)
        return dr.maximum(value, 0) if self.signed else value
