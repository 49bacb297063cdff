"""Hybrid shadow: direct light with shadow volumes that are made from the lights' depth maps.

    L = Σ_lights ρ(ω_l, ω_o) cosθ_l E_l V,   V = 1 where a ray enters as many volumes as it leaves

L is the radiance in the direction ω_o to the camera, ρ the BRDF, ω_l the direction of a light, E_l
its irradiance and V its visibility. Before each picture a depth map of `resolution`² texels is made
for every light. A silhouette lies where its depths jump by more than `jump` widths of a texel.
Walls that start there bound the shadow; each camera ray counts the walls in front of the visible
point (depth-pass) [McCool 2000].

Any shape casts shadows in this way, with or without triangles, and the time depends on the map, not
on meshes. The borders of shadows are jagged, like the texels, and off by some pixels; shadows
thinner than a texel are lost, and surfaces at grazing angles to the light are torn. If the camera
is in a shadow, the whole picture is wrong, as with depth-pass in `shadow_volume`. [Ergun 2008,
section 2.3] rejects the technique for such faults; the plugin exists to show them. There is no
indirect light, and no derivative of the shadows. Lights must be point, spot or directional lights,
cameras perspective; others are refused.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from brdfkit.core.array_types import FloatArray, MitsubaModule, MitsubaObject
from brdfkit.mitsuba_bridge.check_scenes import make_shadow_scene
from brdfkit.mitsuba_bridge.direct_light import derive_shadow_integrator
from brdfkit.mitsuba_bridge.properties.declarations import declare_float, declare_int
from brdfkit.shadows.hybrid import make_hybrid_shadow

PARAMETERS = {
    "resolution": declare_int(256, (2, 4096), "texels along a side of each map"),
    "jump": declare_float(8.0, (0.0, 1e6), "change of depth at a silhouette [width of a texel]"),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_shadow_integrator(mi, PARAMETERS)

    class HybridShadows(Base):
        def prepare_shadows(
            self, scene: MitsubaObject, sensor: MitsubaObject
        ) -> Callable[[MitsubaObject], Any]:
            return partial(
                make_hybrid_shadow, scene, sensor, resolution=self.resolution, jump=self.jump
            )

    return HybridShadows


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene with a shadow, and the radiance (3,) that its picture should have."""
    return make_shadow_scene({"type": "hybrid_shadow", "resolution": 64})
