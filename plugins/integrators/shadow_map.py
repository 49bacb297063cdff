"""Direct light of point, spot and directional lights, shadowed by shadow maps.

    L = Σ_lights ρ(ω_l, ω_o) cosθ_l E_l V,   V from a map of what the light sees

Before each picture every light gets its maps: depths, ray-traced through a `projection`, for each
part of a `partition` of the scene. V is what the `filter` reads there. So the picture has all
faults of the technique, and no others: compare it with `direct`, whose V is a ray to the light.

The techniques are those of [Ergun 2008, section 2.2], and some that came later; each is a file of
`src/brdfkit/shadows/maps/`, in the folder of its kind, which has its formula and what it is good
and bad at. Their settings are parameters here, of which those of other techniques are not asked.

A bias keeps lit surfaces out of their own shadow. By default each texel is compared with the depth
of the surface's own plane in its middle (`plane_bias`), less `bias` of the light's way through the
scene: of the biases that were tried, the one with the least wrong light over low suns, curved
objects, a street and foliage. `slope_bias` and `normal_offset` are what games use in its place.

Derivatives by the geometry go through `variance`, `exponential_variance` and `moment`, silhouettes
included; those through filters that compare are 0. Derivatives by a light's place or direction are
those of the shading alone, as if its maps stood still. There is no indirect light, and other lights
than these three are refused.
"""

from functools import partial

from brdfkit.mitsuba_bridge.check_scenes import beside_a_shadow
from brdfkit.mitsuba_bridge.direct_light import shadowed
from brdfkit.mitsuba_bridge.properties.declarations import count, flag, plain_number, word
from brdfkit.shadows.maps.bias import AUTOMATIC, Bias
from brdfkit.shadows.maps.light_shadow import DEPTHS, LightShadow
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.techniques import FILES, all_settings, settings_of

PARAMETERS = {
    "projection": word(FILES["projection"], "how a map sees the scene", "focused"),
    "filter": word(FILES["filter"], "how a map is read", "depth"),
    "partition": word(FILES["partition"], "how maps share the scene", "whole"),
    "resolution": count(1024, (1, 16384), "texels along a side of each map"),
    "bias": plain_number(AUTOMATIC.constant, (0.0, 1.0), "over the light's way through the scene"),
    "depth": word(DEPTHS, "what a map holds"),
    "slope_bias": plain_number(0.0, (0.0, 100.0), "in steps of depth from texel to texel"),
    "normal_offset": plain_number(0.0, (0.0, 100.0), "along the normal [texels]"),
    "plane_bias": flag(AUTOMATIC.plane, "whether texels are compared with the surface's plane"),
    **all_settings(),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class ShadowMapped(shadowed(mi, PARAMETERS)):
        def shadow_of(self, scene, sensor):
            return partial(self.shadow, scene, sensor)

        def shadow(self, scene, sensor, emitter):
            """The `LightShadow` of an `emitter` of the scene."""
            names = {kind: getattr(self, kind) for kind in FILES}
            settings = [n for kind, name in names.items() for n in settings_of(kind, name)]
            return LightShadow(
                scene,
                Placement.of_scene(scene, sensor, emitter),
                resolution=self.resolution,
                bias=Bias(self.bias, self.slope_bias, self.normal_offset, self.plane_bias),
                depth=self.depth,
                **names,
                **{name: getattr(self, name) for name in settings},
            )

    return ShadowMapped


def reference():
    """See `beside_a_shadow`."""
    return beside_a_shadow({"type": "shadow_map", "resolution": 64})
