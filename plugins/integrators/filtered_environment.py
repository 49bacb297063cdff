"""Filtered environment: direct light of an environment without noise, by default without shadows.

    {"type": "filtered_environment", "method": "gmm"}

The light is filtered once, at `resolution` texels across a hemisphere. After that, one look-up
gives the mean light over a lobe, and every pixel is a sum of such means:

    L(o) ≈ π c E + Σ (f(i, o) - c) cosθ / (N p(i)) · L about i        filtered_sampling
    L(o) ≈ d(o) E + Σ w_k(o) · L about μ_k(o)                         the other methods

o is the direction of view, f the BRDF and c its constant part, E the irradiance divided by π, d the
diffuse albedo, and w_k the weights of lobes about the directions μ_k. `filtered_sampling` draws N =
`samples` directions i from the BSDF; the lower their density p, the wider the lobe about each
[Colbert & Křivánek 2007]. It works with any BSDF at once. The other methods first fit spherical
Gaussians to each BSDF, which takes seconds, and interpolate them between views [Ergun 2015, chapter
8]: `gmm` fits a mixture of `lobes`, and is the most exact; `warped` fits one lobe; `kde` and
`elliptic` replace this lobe by several sharper ones, spread over a circle or an ellipse. These
methods support no textures and no mirrors, and run in RGB and mono variants.

With `filter` = "lobes", levels of the light are convolved with von Mises-Fisher lobes; with "mips"
they are boxes of texels, like the mip levels of graphics hardware, chosen by [Ergun 2015, eq. 8.9].
The scene has one environment, of any kind, and no other lights. Light between surfaces is missing.

With `shadows` = "none", the default, surfaces hide no light. With "shapes", the light of every lobe
and the irradiance are multiplied by their visible share, found from a few directions that count by
the light from there. These directions are the same at every point, so that soft shadows have fine
steps in place of noise. There are 500 such rays per pixel, and a picture takes 10 to 20 times as
long. With "convex", convex parts of meshes cast the shadows, as in `convex_direct`, and other
shapes their own: meshes may move, but pictures take twice the time again, and the parts of a new
mesh take minutes.
"""

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

import drjit as dr

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.lighting.filtering.filtered_light import FILTERS, FilteredLight, Light
from brdfkit.lighting.filtering.filtered_sampling import FilteredSampling
from brdfkit.lighting.filtering.lobe_light import LobeLight
from brdfkit.lighting.spherical_gaussians.lobe_table import METHODS as LOBES
from brdfkit.lighting.visibility.casters import Casters
from brdfkit.lighting.visibility.decomposition import CONCAVITY
from brdfkit.lighting.visibility.occluders import RESOLUTION
from brdfkit.lighting.visibility.shadowed_light import ShadowedLight
from brdfkit.mitsuba_bridge.check_scenes import make_film
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_choice,
    declare_float,
    declare_int,
    declare_text,
    derive_plugin,
)
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised

METHODS = "filtered_sampling", *LOBES
PARAMETERS = {
    "method": declare_text(METHODS[0], ", ".join(METHODS)),
    "samples": declare_int(
        64, (1, 65_536), "directions of filtered_sampling, for all rays of a pixel together"
    ),
    "lobes": declare_int(32, (1, 1024), "lobes per view in gmm, kde and elliptic"),
    "filter": declare_text("lobes", "lobes, or mips like graphics hardware"),
    "resolution": declare_int(512, (32, 1024), "texels across a hemisphere of the light"),
    "shadows": declare_choice(("none", "shapes", "convex"), "what casts shadows"),
    "concavity": declare_float(
        CONCAVITY, (0.01, 1.0), "largest distance of a convex part to its hull"
    ),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_plugin(mi.SamplingIntegrator, PARAMETERS)

    class FilteredEnvironment(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            for name, known in (("method", METHODS), ("filter", FILTERS)):
                if getattr(self, name) not in known:
                    raise no_such_error(name, getattr(self, name), known, "filtered_environment")
            self.shading = _choose_shading(mi, self.method, self.samples, self.lobes)
            self.light = FilteredLight(FILTERS[self.filter], self.resolution)
            self.casters = Casters(self.concavity, RESOLUTION, self.shadows == "convex")

        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[JitFloat]]:
            environment = _require_one_environment(scene)
            unshadowed = self.light.filter_if_changed(
                environment, lambda: self.find_sharpest_lobe(scene, sampler)
            )
            light: Light = unshadowed
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            hit = active & si.is_valid()
            if self.shadows != "none":
                directions = unshadowed.get_light_directions(sampler.sample_count())
                visible = self.make_visibility_test(scene, si, hit)
                sharpness = self.shading.shadow_sharpness
                light = ShadowedLight(unshadowed, si, visible, directions, sharpness)
            reflected = self.shading.radiance(scene, sampler, si, light, hit)
            behind = mi.unpolarized_spectrum(environment.eval(si, active & ~hit))
            return mi.depolarizer(dr.select(hit, reflected, behind)), active, []

        def find_sharpest_lobe(self, scene: MitsubaObject, sampler: MitsubaObject) -> float:
            """Return the largest concentration κ of the lobes of light; infinite if not known."""
            if self.shadows != "none":
                return inf  # shadow rays are weighted by the light over sharper lobes
            return self.shading.find_sharpest_lobe(scene, sampler)

        def make_visibility_test(
            self, scene: MitsubaObject, si: MitsubaObject, active: JitMask
        ) -> Callable[[JitVector], JitMask]:
            """Return a function that tests whether light from a direction reaches the points."""
            return lambda w: self.casters.is_visible(scene, si.spawn_ray(w), active)

    return FilteredEnvironment


def _choose_shading(
    mi: MitsubaModule, method: str, samples: int, lobes: int
) -> FilteredSampling | LobeLight:
    """Return the object that computes the reflected light by the method with this name."""
    if method == METHODS[0]:
        return FilteredSampling(samples)
    if mi.is_spectral:
        raise BrdfkitError(
            f"filtered_environment: the lobes of {method} have colours in linear sRGB; set "
            "llvm_ad_rgb, or take filtered_sampling."
        )
    return LobeLight(method, lobes)


def _require_one_environment(scene: MitsubaObject) -> MitsubaObject:
    """Return a scene's environment, or raise `BrdfkitError` without one or with other lights."""
    require_vectorised("filtered_environment")
    if scene.environment() is None:
        raise BrdfkitError(
            "filtered_environment: the scene has no environment to light it; add an envmap."
        )
    if len(scene.emitters()) > 1:
        raise BrdfkitError(
            "filtered_environment: the scene has lamps besides its environment; remove them, or "
            "render it with the integrator path."
        )
    return scene.environment()


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene, a matte wall in even light, and the radiance (3,) of its picture."""
    import mitsuba as mi

    albedo, radiance = 0.4, 0.7
    camera = mi.ScalarTransform4f().look_at([0, 0, 3], [0, 0, 0], [0, 1, 0])
    scene = {
        "type": "scene",
        "integrator": {"type": "filtered_environment", "resolution": 64},
        "sensor": {"type": "perspective", "fov": 20, "to_world": camera, "film": make_film()},
        "wall": {
            "type": "rectangle",
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}},
        },
        "light": {"type": "constant", "radiance": {"type": "rgb", "value": radiance}},
    }
    return scene, [albedo * radiance] * 3
