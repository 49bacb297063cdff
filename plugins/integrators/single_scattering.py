"""Single scattering: volumes in the light of a scene, by random collisions, without bias.

    L = T(0, d) L_behind + ∫ T(0, s) [e(s) + σ(s) α(s) ∫ p(ω, ω') L_in(s, ω') dω'] ds
    T(0, s) = exp(-∫ σ dt) from 0 to s

`extinction` σ, times `scale`, `albedo` α and `emission` e, radiance per length, are volumes; all is
within the box of σ, which lies along the world's axes unless σ is a `transfer_function`. Such a one
has a colour as well: α is the albedo times it, or σ times it is added to e. In spectral variants e
is multiplied by D65. `phase` p is any phase function. L_in is what emitters send straight through
the volume.

Every emitter shines: points, directions, surfaces, environments. A surface before, in or behind
the volume shows what it emits, and by its BSDF the light of the emitters that reaches it through
the volume; it casts a shadow, also where its BSDF lets light pass. Behind all is the environment.

Ratio tracking along a ray finds both the share of light that comes through and a collision of the
rest: each sample has what is seen behind the volume, and light that is scattered in it. Likewise it
finds what comes through to an emitter, once towards a sample of the emitters, of several mostly the
brightest of two, once in a direction that the phase function or the BSDF draws; the power heuristic
weights the two. `majorants` are the bounds of σ by which it steps: `local`, those of coarse cells,
several times faster for scans with much that is empty, or `global`, one for all. They are found
anew when parameters change; an extinction above them is an error, and were one missed, a pixel that
is no number.

`max_depth` is that of Mitsuba's `volpath`: 1 for what shines by itself, seen through the volume, 2
for single scattering, more for multiple scattering. The means are equal, but for what `volpath`
loses: 1.3e-4 σ of the light of thick media, and some light of spheres that are near.

Derivatives go to the volumes, the phase function, the BSDFs and the emitters' radiance, at any
`max_depth`, without bias where σ is above 0; where it is 0, the light that more of it would scatter
is missing in them, so that a search for a volume begins above 0. What appears or vanishes at a
surface's edge is missing, too.

[Lesar 2018, chapter 6]; [Woodcock et al. 1965]; [Novák et al. 2014]; [Veach & Guibas 1995].
"""

import math

import drjit as dr
import numpy as np

from brdfkit.mitsuba_bridge.check_scenes import through_unit_cube
from brdfkit.mitsuba_bridge.properties.declarations import (
    count,
    declared,
    number,
    phase,
    volume,
    word,
)
from brdfkit.mitsuba_bridge.registration.registering import refuse_scalar
from brdfkit.volumes.light import emitters
from brdfkit.volumes.light.medium import Medium
from brdfkit.volumes.light.vertex import Vertex, medium_interaction

ROULETTE = 5  # scatterings after which faint paths end at random
LEAST_CHANCE = 0.05  # of going on then, and of being one of two

PARAMETERS = {
    "extinction": volume(1.0, "σ: collisions per unit of length", coloured=False),
    "scale": number(1.0, (0.0, math.inf), "what σ is multiplied by"),
    "albedo": volume(1.0, "α: the share of what collides that is scattered"),
    "emission": volume(0.0, "e: radiance that is added per unit of length"),
    "phase": phase("p: where light is scattered to, by default evenly anywhere"),
    "max_depth": count(2, (1, 1_000_000), "segments of a path at most, 2 for single scattering"),
    "majorants": word(("local", "global"), "bounds of σ: of coarse cells, or one for all"),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class SingleScattering(declared(mi.SamplingIntegrator, PARAMETERS)):
        def __init__(self, props):
            self.name, self.emits = props.plugin_name(), "emission" in props
            super().__init__(props)
            self.medium = Medium(self.extinction, self.scale, self.albedo, self.emission)
            self.parameters_changed()

        def parameters_changed(self, keys=()):
            if not mi.variant().startswith("scalar"):
                self.medium.bound(self.majorants == "local")

        def sample(self, scene, sampler, ray, medium=None, active=True):
            refuse_scalar(self.name)

            def goes_on(depth, ray, throughput, *_):
                return active & (depth < self.max_depth) & dr.any(throughput != 0)

            def step(depth, ray, throughput, radiance, density, sampler):
                going = goes_on(depth, ray, throughput)
                light, vertex, weight = self.segment(scene, ray, density, sampler, going)
                radiance += throughput * light
                throughput *= weight
                radiance += throughput * self.direct(scene, vertex, sampler)
                wo, weight, density = vertex.sample(sampler)
                ray = dr.select(vertex.active, vertex.interaction.spawn_ray(wo), ray)
                throughput = roulette(depth, throughput * weight, sampler)
                return depth + 1, ray, throughput, radiance, density, sampler

            one, zero = mi.UnpolarizedSpectrum(1), mi.UnpolarizedSpectrum(0)
            state = mi.UInt32(1), mi.Ray3f(ray), one, zero, mi.Float(0), sampler
            if self.max_depth > 1:
                state = dr.while_loop(state, goes_on, step, max_iterations=self.max_depth - 1)
            _, ray, throughput, radiance, density, _ = state
            going = active & dr.any(throughput != 0)
            radiance += throughput * self.last_segment(scene, ray, density, sampler, going)
            return mi.depolarizer(dr.select(active, radiance, 0)), active, []

        def segment(self, scene, ray, density, sampler, active):
            """Follow rays to where they collide and where they end: the light found, one of the
            two as the vertex, and the share of light that is scattered there."""
            si = scene.ray_intersect(ray, active)
            share, collided, t = self.medium.divide(ray, si.t, sampler, active)
            light = share * emitters.seen(scene, ray, si, density, active)

            # From one of the two ends the path goes on: the collision, or a surface behind it
            passed = dr.select(si.is_valid(), dr.detach(share), 0)
            in_medium = active & (sampler.next_1d(active) * (collided + passed) < collided)
            mei = medium_interaction(ray, t)
            sigma, albedo, own = self.medium.matter(mei, in_medium)
            # 1, with the derivatives of σ T at a collision, of T at a surface
            depth = self.medium.depth(ray, dr.select(in_medium, t, si.t), sampler, active)
            log_sigma = dr.log(dr.select(in_medium, sigma, 1))
            weight = (collided + passed) * dr.replace_grad(mi.Float(1), log_sigma - depth)
            light += dr.select(in_medium, weight * own, 0)
            if self.emits:
                light += self.medium.glow(ray, si.t, sampler, active)
            on_surface = active & ~in_medium & si.is_valid()
            vertex = Vertex(self.phase, mei, in_medium, si, on_surface)
            return light, vertex, weight * dr.select(in_medium, albedo, 1)

        def direct(self, scene, vertex, sampler):
            """Light of the emitters that is scattered into the rays at a vertex.

            Of several emitters, two halves have a sample each, of which one is followed.
            """
            u = sampler.next_2d(vertex.active)
            if len(scene.emitters()) > 1:
                halves = [mi.Point2f((u.x + k) / 2, u.y) for k in range(2)]
                both = [self.unshadowed(scene, vertex, half) for half in halves]
                ray, light, lit = one_of(*both, sampler.next_1d(vertex.active))
            else:
                ray, light, lit = self.unshadowed(scene, vertex, u)
            with dr.suspend_grad():
                lit = lit & ~scene.ray_test(ray, lit)
            share = self.medium.transmittance(ray, ray.maxt, sampler, lit)
            return dr.select(lit, light * share, 0)

        def unshadowed(self, scene, vertex, u):
            """The ray to a sample of the emitters, the light that would be scattered, and whether
            there is a sample."""
            it = vertex.interaction
            ds, light, there = emitters.sampled(scene, it, u, vertex.active)
            value, pdf = vertex.eval_pdf(ds.d)
            weight = dr.select(ds.delta, 1, emitters.power_heuristic(ds.pdf, dr.detach(pdf)))
            return emitters.ray_to(it, ds), value * light * weight, there

        def last_segment(self, scene, ray, density, sampler, active):
            """The light that comes through along rays."""
            si = scene.ray_intersect(ray, active)
            comes = active & emitters.are_met(scene, si)
            light = emitters.seen(scene, ray, si, density, comes)
            light *= self.medium.transmittance(ray, si.t, sampler, comes)
            own = self.medium.colour == "emission"
            if self.emits or own:
                light += self.medium.glow(ray, si.t, sampler, active, own)
            return light

    return SingleScattering


def one_of(first, second, u):
    """Of two (ray, light, mask) mostly the brighter one; its light stands for the mean of both."""
    brightness = [dr.detach(dr.max(light)) for _, light, _ in (first, second)]
    both = brightness[0] + brightness[1]
    chance = dr.select(both > 0, brightness[0] / both, 0.5)
    chance = dr.clip(chance, LEAST_CHANCE, 1 - LEAST_CHANCE)
    is_first = u < chance
    ray, light, mask = (dr.select(is_first, a, b) for a, b in zip(first, second, strict=True))
    return ray, light / (2 * dr.select(is_first, chance, 1 - chance)), mask


def roulette(depth, throughput, sampler):
    """The throughput of paths of which faint ones end at random, and others stand for them.

    Paths as bright as at first all go on: in white clouds, where they are long, a few that stand
    for very many would else be missed, and pictures be too dark.
    """
    chance = dr.clip(dr.max(dr.detach(throughput)), LEAST_CHANCE, 1)
    chance = dr.select(depth < ROULETTE, 1, chance)
    return dr.select(sampler.next_1d() < chance, throughput / chance, 0)


def reference():
    """A scene, and the radiance (3,) of each of its pixels.

    An even cube in the sun, which is behind the camera.
    """
    sigma, albedo, g, irradiance = 2.0, 0.5, -0.3, np.array([0.9, 0.6, 0.3])
    colour = {"type": "rgb", "value": irradiance.tolist()}
    scene = {
        "type": "scene",
        "integrator": {
            "type": "single_scattering",
            "extinction": sigma,
            "albedo": albedo,
            "phase": {"type": "hg", "g": g},
        },
        "sensor": through_unit_cube(),
        "sun": {"type": "directional", "direction": [0, 0, -1], "irradiance": colour},
    }
    back = (1 - g**2) / (4 * math.pi * (1 + g**2 + 2 * g) ** 1.5)  # Henyey-Greenstein at μ = -1
    return scene, irradiance * albedo * back * (1 - math.exp(-2 * sigma)) / 2
