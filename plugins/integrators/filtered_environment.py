"""Filtered environment: direct light from all around, without noise, by default without shadows.

    {"type": "filtered_environment", "method": "gmm"}

The light is filtered once, at `resolution` texels across a hemisphere. Then every mean of it over a
lobe is one look-up, and a pixel takes some of them, the same ones everywhere:

    L(o) ≈ π c E + Σ (f(i, o) - c) cosθ / (N p(i)) · L about i        filtered_sampling
    L(o) ≈ d(o) E + Σ w_k(o) · L about μ_k(o)                         the other methods

E is the irradiance. `filtered_sampling` takes N = `samples` directions i of the BSDF; the fewer of
them, by their density p, the wider the lobe about each [Colbert & Křivánek 2007]. It takes any
BSDF at once. The others fit spherical Gaussians to each BSDF first, which takes seconds, and
interpolate them between views [Ergun 2015, chapter 8]: `gmm` a mixture of `lobes`, the most exact;
`warped` one lobe, `kde` and `elliptic` sharper ones in its place, spread over a circle or an
ellipse. They see no textures and no mirrors, and run in RGB and mono variants.

`filter` = "lobes": levels of the light that are convolved with von Mises-Fisher lobes; "mips":
boxes of texels, as graphics hardware has them, by the rule of [Ergun 2015, eq. 8.9]. The scene has
one environment, of any kind, and no other lights. Light between surfaces is missing.

`shadows` = "shapes" dims the light of every lobe, and the irradiance, by the share that is visible:
that of a few directions, each of which counts by the light that comes from it. They are the same
ones at every point, so that soft shadows have fine steps in place of noise. They are 500 rays per
pixel, and a picture takes 10 to 20 times as long. With "convex", convex parts of meshes cast the
shadows, found once, and other shapes, as in `convex_direct`: they may move, but take twice the
time, and minutes for the parts of a mesh that is new. By default, "none", surfaces hide nothing.
"""

import drjit as dr

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.lighting.filtering.filtered_light import FILTERS, FilteredLight
from brdfkit.lighting.filtering.filtered_sampling import FilteredSampling
from brdfkit.lighting.filtering.lobe_light import LobeLight
from brdfkit.lighting.spherical_gaussians.lobe_table import METHODS as LOBES
from brdfkit.lighting.visibility.casters import Casters
from brdfkit.lighting.visibility.decomposition import CONCAVITY
from brdfkit.lighting.visibility.occluders import RESOLUTION
from brdfkit.lighting.visibility.shadowed_light import ShadowedLight
from brdfkit.mitsuba_bridge.check_scenes import reference_film
from brdfkit.mitsuba_bridge.properties.declarations import count, declared, plain_number, text, word
from brdfkit.mitsuba_bridge.registration.registering import refuse_scalar

METHODS = "filtered_sampling", *LOBES
PARAMETERS = {
    "method": text(METHODS[0], ", ".join(METHODS)),
    "samples": count(
        64, (1, 65_536), "directions per pixel, of all its rays, of filtered_sampling"
    ),
    "lobes": count(32, (1, 1024), "lobes per view, of gmm, kde and elliptic"),
    "filter": text("lobes", "lobes, or mips as of graphics hardware"),
    "resolution": count(512, (32, 1024), "texels across a hemisphere of the light"),
    "shadows": word(("none", "shapes", "convex"), "what casts shadows"),
    "concavity": plain_number(
        CONCAVITY, (0.01, 1.0), "largest distance of a convex part to its hull"
    ),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class FilteredEnvironment(declared(mi.SamplingIntegrator, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            for name, known in (("method", METHODS), ("filter", FILTERS)):
                if getattr(self, name) not in known:
                    raise no_such(name, getattr(self, name), known, where="filtered_environment")
            self.shading = _shading(mi, self.method, self.samples, self.lobes)
            self.light = FilteredLight(FILTERS[self.filter], self.resolution)
            self.casters = Casters(self.concavity, RESOLUTION, self.shadows == "convex")

        def sample(self, scene, sampler, ray, medium=None, active=True):
            environment = _only_environment(mi, scene)
            light = self.light.update(environment)
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            hit = active & si.is_valid()
            if self.shadows != "none":
                directions = light.light_directions(sampler.sample_count())
                light = ShadowedLight(light, si, self.visible(scene, si, hit), directions)
            shown = self.shading.radiance(scene, sampler, si, light, hit)
            behind = mi.unpolarized_spectrum(environment.eval(si, active & ~hit))
            return mi.depolarizer(dr.select(hit, shown, behind)), active, []

        def visible(self, scene, si, active):
            """Whether the light from a direction reaches the points `si`."""
            return lambda w: self.casters.visible(scene, si.spawn_ray(w), active)

    return FilteredEnvironment


def _shading(mi, method, samples, lobes):
    """What lights a surface, by the name of the `method`."""
    if method == METHODS[0]:
        return FilteredSampling(samples)
    if mi.is_spectral:
        raise BrdfkitError(
            f"filtered_environment: the lobes of {method} have colours in linear sRGB; set "
            "llvm_ad_rgb, or take filtered_sampling."
        )
    return LobeLight(method, lobes)


def _only_environment(mi, scene):
    """The environment of a `scene`; `BrdfkitError` where it has none, or other lights."""
    refuse_scalar("filtered_environment")
    if scene.environment() is None:
        raise BrdfkitError(
            "filtered_environment: the scene has no environment to light it; add an envmap."
        )
    if len(scene.emitters()) > 1:
        raise BrdfkitError(
            "filtered_environment: the scene has lamps besides its environment; take them out, or "
            "render it with path."
        )
    return scene.environment()


def reference():
    """A scene, and the radiance (3,) of each of its pixels: a matte wall in even light."""
    import mitsuba as mi

    albedo, radiance = 0.4, 0.7
    camera = mi.ScalarTransform4f().look_at([0, 0, 3], [0, 0, 0], [0, 1, 0])
    scene = {
        "type": "scene",
        "integrator": {"type": "filtered_environment", "resolution": 64},
        "sensor": {"type": "perspective", "fov": 20, "to_world": camera, "film": reference_film()},
        "wall": {
            "type": "rectangle",
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}},
        },
        "light": {"type": "constant", "radiance": {"type": "rgb", "value": radiance}},
    }
    return scene, [albedo * radiance] * 3
