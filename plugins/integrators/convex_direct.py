"""Convex shadows: direct light, with shadows of convex parts of meshes, which may move.

    L = L_e + Σ_s ρ(ω_s, ω_o) L(ω_s) V(ω_s) cosθ_s / (p_b(ω_s) + p_e(ω_s))

L is the radiance in the direction ω_o to the camera, L_e the emission of the surface, ρ its BRDF. A
sample of a pixel has two directions ω_s, one drawn by the BSDF (density p_b) and one by the lights
(p_e), combined by the balance heuristic. V is 0 where a convex part blocks the light. Every mesh
that encloses a volume is cut into nearly convex parts when the scene is first rendered. This takes
seconds to minutes, is stored in the user's cache folder, and needs coacd: `pip install
'brdfkit[visibility]'`. `concavity` says how far a part may be from its convex hull. Each part has a
map of its faces by direction, in which a ray finds its entry into the part in about two look-ups.
Other shapes, such as spheres, grounds and lamps, cast exact shadows. Camera rays meet the exact
surfaces.

[Ergun 2015, section 7.2]. Passes with different seeds can be averaged to reduce the noise. Shadows
are approximate: they are too large where a hull is thicker than the mesh, and objects cast no
shadow on points nearer than 1.5 % of the mesh's size. The light should be an environment, such as
`kdtree_envmap`; other lights are sampled only by themselves, not by the BSDF. There is no indirect
light, and the light is unpolarised.

In Python an object can move without rebuilding the tree over its triangles, by a matrix from its
first place: `integrator.occluders(scene).move(id, matrix)`. This moves its shadow; the visible
object is moved as usual in Mitsuba.
"""

import math
from collections.abc import Sequence
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.lighting.visibility.casters import Casters
from brdfkit.lighting.visibility.decomposition import CONCAVITY
from brdfkit.lighting.visibility.occluders import RESOLUTION, Occluders
from brdfkit.mitsuba_bridge.check_scenes import make_film
from brdfkit.mitsuba_bridge.properties.declarations import declare_float, declare_int, derive_plugin

PARAMETERS = {
    "concavity": declare_float(CONCAVITY, (0.01, 1.0), "largest distance of a part to its hull"),
    "resolution": declare_int(
        RESOLUTION, (4, 1024), "texels along a side of the largest part's map"
    ),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_plugin(mi.SamplingIntegrator, PARAMETERS)

    class ConvexDirect(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.casters = Casters(self.concavity, self.resolution)

        def occluders(self, scene: MitsubaObject) -> Occluders | None:
            """Return the convex parts that cast the shadows, None if no mesh encloses a volume."""
            return self.casters.find_casters(scene)[0]

        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[JitFloat]]:
            # Find the visible surface and the light that it emits
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            hit = active & si.is_valid()
            emitter = si.emitter(scene)
            radiance = mi.UnpolarizedSpectrum(0)
            if emitter is not None:
                radiance += mi.unpolarized_spectrum(emitter.eval(si, active))

            bsdf = si.bsdf()
            radiance += self.reflect_emitter_sample(scene, si, bsdf, sampler.next_2d(), hit)
            samples = sampler.next_1d(), sampler.next_2d()
            radiance += self.reflect_bsdf_sample(scene, si, bsdf, *samples, hit)
            return mi.depolarizer(dr.select(active, radiance, 0)), active, []

        def reflect_emitter_sample(
            self,
            scene: MitsubaObject,
            si: MitsubaObject,
            bsdf: MitsubaObject,
            sample: JitVector,
            active: JitMask,
        ) -> JitColour:
            """Return the reflected light from one direction that the emitters draw."""
            active = active & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
            ds, light = scene.sample_emitter_direction(si, sample, False, active)
            active = active & (ds.pdf > 0)
            wo = si.to_local(ds.d)
            value, pdf = bsdf.eval_pdf(mi.BSDFContext(), si, wo, active)
            infinite = mi.has_flag(ds.emitter.flags(), mi.EmitterFlags.Infinite)
            # The BSDF samples only the environment, so its density for other lights is 0
            pdf = dr.select(infinite, dr.select(ds.delta, 0, pdf), 0)
            weight = ds.pdf / dr.select(active, ds.pdf + pdf, 1)
            reflected = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * weight
            visible = self.casters.is_visible(scene, si.spawn_ray_to(ds.p), active)
            return dr.select(visible, reflected, 0)

        def reflect_bsdf_sample(
            self,
            scene: MitsubaObject,
            si: MitsubaObject,
            bsdf: MitsubaObject,
            sample1: JitFloat,
            sample2: JitVector,
            active: JitMask,
        ) -> JitColour:
            """Return reflected light of the environment from one direction that the BSDF draws."""
            environment = scene.environment()
            if environment is None:
                return mi.UnpolarizedSpectrum(0)
            bs, value = bsdf.sample(mi.BSDFContext(), si, sample1, sample2, active)
            active = active & (bs.pdf > 0)
            ray = si.spawn_ray(si.to_world(bs.wo))

            # Look up the environment's light in this direction, and the density of drawing it
            far = mi.SurfaceInteraction3f(si)
            far.t, far.wi = dr.inf, -ray.d
            ds = mi.DirectionSample3f(scene, far, si)
            pdf = scene.pdf_emitter_direction(si, ds, active)
            pdf = dr.select(mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta), 0, pdf)
            light = mi.unpolarized_spectrum(environment.eval(far, active))
            weight = bs.pdf / dr.select(active, bs.pdf + pdf, 1)
            reflected = mi.unpolarized_spectrum(value) * light * weight
            return dr.select(self.casters.is_visible(scene, ray, active), reflected, 0)

    return ConvexDirect


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene, and the radiance (3,) that every pixel of its picture should have.

    The camera looks at the ground below the centre of a cube, under a sky of constant radiance L.
    The ground has the radiance albedo · (1 - F) L, where F is the form factor of the cube's lower
    face, made of four rectangles with a corner above the point.
    """
    import mitsuba as mi

    albedo, sky, half, height = 0.5, np.array([0.9, 0.6, 0.3]), 0.5, 0.5
    t = mi.ScalarTransform4f
    camera = t().look_at([0, 0, height / 2], [0, 0, 0], [0, 1, 0]).scale(1e-3)
    grey = {"type": "rgb", "value": [albedo] * 3}
    cube = t().translate([0, 0, height + half]).scale(half)
    scene = {
        "type": "scene",
        "integrator": {"type": "convex_direct"},
        "sensor": {"type": "orthographic", "to_world": camera, "film": make_film(16)},
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": sky.tolist()}},
        "ground": {"type": "rectangle", "bsdf": {"type": "diffuse", "reflectance": grey}},
        "cube": {"type": "cube", "to_world": cube},
    }
    side = half / height
    root = math.sqrt(1 + side**2)
    hidden = 4 / math.pi * side / root * math.atan(side / root)
    return scene, albedo * sky * (1 - hidden)
