"""Direct light with shadows of convex parts: those of meshes, which may move between pictures.

    L = L_e + Σ_s ρ(ω_s, ω_o) L(ω_s) V(ω_s) cosθ_s / (p_b(ω_s) + p_e(ω_s))

with two directions ω_s per sample of a pixel, one drawn by the BSDF (density p_b) and one by the
lights (p_e): the balance heuristic. V is 0 where a convex part lies in the way. Every mesh that
encloses a volume is cut into nearly convex parts when the scene is first rendered, which takes
seconds to minutes and is kept in the user's cache folder (it needs coacd: `pip install
'brdfkit[visibility]'`); `concavity` says how far a part may be from its hull. Each part has a map
of its faces by direction, in which a ray finds where it enters the part in two look-ups or so.
Other shapes (spheres, grounds, lamps) cast their own shadows. Camera rays meet the surfaces as they
are.

[Ergun 2015, section 7.2]. A picture is the mean of its passes: more passes with other seeds refine
it. Shadows are approximate: too large where a hull is thicker than the mesh, and missing on a point
from what is nearer than 1.5 % of the mesh's size. The light should be an environment, such as
`kdtree_envmap`; other lights are sampled by themselves alone. There is no indirect light, and what
comes back is unpolarised.

In Python an object is moved without a new tree over its triangles, by a matrix from its first
place: `integrator.occluders(scene).move(id, matrix)`. That moves its shadow; what the camera sees
is moved as ever in Mitsuba.
"""

import math

import drjit as dr
import numpy as np

from brdfkit.lighting.visibility.casters import Casters
from brdfkit.lighting.visibility.decomposition import CONCAVITY
from brdfkit.lighting.visibility.occluders import RESOLUTION
from brdfkit.mitsuba_bridge.check_scenes import reference_film
from brdfkit.mitsuba_bridge.properties.declarations import count, declared, plain_number

PARAMETERS = {
    "concavity": plain_number(CONCAVITY, (0.01, 1.0), "largest distance of a part to its hull"),
    "resolution": count(RESOLUTION, (4, 1024), "texels along a side of the largest part's map"),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class ConvexDirect(declared(mi.SamplingIntegrator, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            self.casters = Casters(self.concavity, self.resolution)

        def occluders(self, scene):
            """The `Occluders` of the scene's meshes, None where no mesh encloses a volume."""
            return self.casters.of(scene)[0]

        def sample(self, scene, sampler, ray, medium=None, active=True):
            # What the camera sees, and its own light
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            seen = active & si.is_valid()
            emitter = si.emitter(scene)
            radiance = mi.UnpolarizedSpectrum(0)
            if emitter is not None:
                radiance += mi.unpolarized_spectrum(emitter.eval(si, active))

            bsdf = si.bsdf()
            radiance += self.light_by_emitters(scene, si, bsdf, sampler.next_2d(), seen)
            samples = sampler.next_1d(), sampler.next_2d()
            radiance += self.light_by_bsdf(scene, si, bsdf, *samples, seen)
            return mi.depolarizer(dr.select(active, radiance, 0)), active, []

        def light_by_emitters(self, scene, si, bsdf, sample, active):
            active = active & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
            ds, light = scene.sample_emitter_direction(si, sample, False, active)
            active = active & (ds.pdf > 0)
            wo = si.to_local(ds.d)
            value, pdf = bsdf.eval_pdf(mi.BSDFContext(), si, wo, active)
            infinite = mi.has_flag(ds.emitter.flags(), mi.EmitterFlags.Infinite)
            pdf = dr.select(infinite, dr.select(ds.delta, 0, pdf), 0)  # 0: by the BSDF never drawn
            weight = ds.pdf / dr.select(active, ds.pdf + pdf, 1)
            found = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * weight
            return dr.select(self.casters.visible(scene, si.spawn_ray_to(ds.p), active), found, 0)

        def light_by_bsdf(self, scene, si, bsdf, sample1, sample2, active):
            environment = scene.environment()
            if environment is None:
                return mi.UnpolarizedSpectrum(0)
            bs, value = bsdf.sample(mi.BSDFContext(), si, sample1, sample2, active)
            active = active & (bs.pdf > 0)
            ray = si.spawn_ray(si.to_world(bs.wo))

            # The environment in this direction, and its density
            far = mi.SurfaceInteraction3f(si)
            far.t, far.wi = dr.inf, -ray.d  # beyond all surfaces
            ds = mi.DirectionSample3f(scene, far, si)
            pdf = scene.pdf_emitter_direction(si, ds, active)
            pdf = dr.select(mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta), 0, pdf)
            light = mi.unpolarized_spectrum(environment.eval(far, active))
            found = (
                mi.unpolarized_spectrum(value)
                * light
                * (bs.pdf / dr.select(active, bs.pdf + pdf, 1))
            )
            return dr.select(self.casters.visible(scene, ray, active), found, 0)

    return ConvexDirect


def reference():
    """A scene, and the radiance (3,) of each of its pixels: (1 - F) L times the albedo.

    A ground under an even sky, right below the middle of a cube. F is the share of the sky that the
    cube's lower face hides, by the cosine: the form factor of four rectangles with a corner above.
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
        "sensor": {"type": "orthographic", "to_world": camera, "film": reference_film(16)},
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": sky.tolist()}},
        "ground": {"type": "rectangle", "bsdf": {"type": "diffuse", "reflectance": grey}},
        "cube": {"type": "cube", "to_world": cube},
    }
    side = half / height
    root = math.sqrt(1 + side**2)
    hidden = 4 / math.pi * side / root * math.atan(side / root)
    return scene, albedo * sky * (1 - hidden)
