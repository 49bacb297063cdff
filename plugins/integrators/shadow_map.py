"""Shadow map: direct light of point, spot and directional lights, with shadow maps.

    L = Σ_lights ρ(ω_l, ω_o) cosθ_l E_l V,   V: visibility of the light, read from a shadow map

L is the radiance in the direction ω_o to the camera, ρ the BRDF, ω_l the direction of a light and
E_l its irradiance. Before each picture, every light gets one map for each part of a `partition` of
the scene: depths, ray-traced through a `projection`. The `filter` reads V from these maps. The
picture shows all faults of the technique, and no others: compare it with Mitsuba's `direct`, which
follows a ray to the light.

The techniques are from [Ergun 2008, section 2.2] and later work. Each one is a file in
`src/brdfkit/shadows/maps/`, in the folder of its kind, and the file explains its formula, strengths
and weaknesses. Their settings are parameters here; settings of techniques that are not in use are
ignored.

A bias keeps lit surfaces out of their own shadow. By default each texel is compared with the depth
of the surface's tangent plane at the texel's centre (`plane_bias`), minus `bias` times the length
of the light's way through the scene. This bias had the fewest wrong pixels in tests with low suns,
curved objects, a street and foliage. `slope_bias` and `normal_offset` are common in games instead.

Derivatives with respect to the geometry flow through the filters `variance`, `exponential_variance`
and `moment`, including silhouettes; through filters that compare depths they are 0. Derivatives
with respect to a light's position or direction include the shading, but not the change of its maps.
There is no indirect light, and other kinds of lights are refused.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from brdfkit.core.array_types import FloatArray, MitsubaModule, MitsubaObject
from brdfkit.mitsuba_bridge.check_scenes import make_shadow_scene
from brdfkit.mitsuba_bridge.direct_light import derive_shadow_integrator
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_bool,
    declare_choice,
    declare_float,
    declare_int,
)
from brdfkit.shadows.maps.light_shadow import DEPTHS, LightShadow
from brdfkit.shadows.maps.map_point import AUTOMATIC, Bias
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.techniques import FILES, find_settings, list_settings

PARAMETERS = {
    "projection": declare_choice(FILES["projection"], "how a map projects the scene", "focused"),
    "filter": declare_choice(FILES["filter"], "how a map is read", "depth"),
    "partition": declare_choice(FILES["partition"], "how the scene is divided among maps", "whole"),
    "resolution": declare_int(1024, (1, 16384), "texels along a side of each map"),
    "bias": declare_float(AUTOMATIC.constant, (0.0, 1.0), "share of the light's way in the scene"),
    "depth": declare_choice(DEPTHS, "the kind of depth that a map holds"),
    "slope_bias": declare_float(0.0, (0.0, 100.0), "bias in steps of depth from texel to texel"),
    "normal_offset": declare_float(0.0, (0.0, 100.0), "bias along the normal [texels]"),
    "plane_bias": declare_bool(
        AUTOMATIC.plane, "whether texels are compared with the tangent plane"
    ),
    **list_settings(),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_shadow_integrator(mi, PARAMETERS)

    class ShadowMapped(Base):
        def prepare_shadows(
            self, scene: MitsubaObject, sensor: MitsubaObject
        ) -> Callable[[MitsubaObject], LightShadow]:
            return partial(self.make_light_shadow, scene, sensor)

        def make_light_shadow(
            self, scene: MitsubaObject, sensor: MitsubaObject, emitter: MitsubaObject
        ) -> LightShadow:
            """Render the shadow maps of an `emitter` and return them as a `LightShadow`."""
            names = {kind: getattr(self, kind) for kind in FILES}
            settings = [s for kind, name in names.items() for s in find_settings(kind, name)]
            return LightShadow(
                scene,
                Placement.from_scene(scene, sensor, emitter),
                resolution=self.resolution,
                bias=Bias(self.bias, self.slope_bias, self.normal_offset, self.plane_bias),
                depth=self.depth,
                **names,
                **{name: getattr(self, name) for name in settings},
            )

    return ShadowMapped


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene with a shadow, and the radiance (3,) that its picture should have."""
    return make_shadow_scene({"type": "shadow_map", "resolution": 64})
