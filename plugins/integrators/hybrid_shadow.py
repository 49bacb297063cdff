"""Direct light of point, spot and directional lights, shadowed by volumes out of depth maps.

    L = Σ_lights ρ(ω_l, ω_o) cosθ_l E_l V,   V = 1 where a ray enters as many volumes as it leaves

Before each picture a depth map of `resolution`² texels is made for every light. Where its depths
jump by more than `jump` texels' widths there is a silhouette. Walls from there bound the shadow;
each ray of the camera counts those before the point that it sees (depth-pass) [McCool 2000].

Any shape casts shadows so, with or without triangles, and the time depends on the map, not on
meshes. Borders are those of texels, some pixels off and jagged; shadows thinner than a texel are
lost, and surfaces that the light grazes are torn. As by depth-pass in `shadow_volume`, all is wrong
where the eye is in a shadow. [Ergun 2008, section 2.3] leaves the kind out for such faults; this is
to see them. There is no indirect light, and no derivative of the shadows; other lights than these
three are refused, and cameras that are not perspective.
"""

from functools import partial

from brdfkit.mitsuba_bridge.check_scenes import beside_a_shadow
from brdfkit.mitsuba_bridge.direct_light import shadowed
from brdfkit.mitsuba_bridge.properties.declarations import count, plain_number
from brdfkit.shadows.hybrid import hybrid_shadow

PARAMETERS = {
    "resolution": count(256, (2, 4096), "texels along a side of each map"),
    "jump": plain_number(8.0, (0.0, 1e6), "change of depth at a silhouette [width of a texel]"),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class HybridShadows(shadowed(mi, PARAMETERS)):
        def shadow_of(self, scene, sensor):
            how = {"resolution": self.resolution, "jump": self.jump}
            return partial(hybrid_shadow, scene, sensor, **how)

    return HybridShadows


def reference():
    """See `beside_a_shadow`."""
    return beside_a_shadow({"type": "hybrid_shadow", "resolution": 64})
