"""Direct light of point, spot and directional lights, shadowed by stencil shadow volumes.

    L = Σ_lights ρ(ω_l, ω_o) cosθ_l E_l V,   V = 1 where a ray enters as many volumes as it leaves

Before each picture the shapes become volumes: walls from their silhouettes away from the light, and
caps that close them [Crow 1977]. Each ray of the camera then counts their faces, as the stencil
buffer of a graphics card does for each sample of a pixel [Heidmann 1991]: those before the point
that it sees (`depth_pass`) or those behind it (`depth_fail`). Entering adds 1, leaving takes 1.

`depth_fail` [Everitt & Kilgard 2002] gives the shadows that rays give. `depth_pass` does so where
the eye is in no shadow, the near plane cuts none, and no light goes through surfaces; `near_cap`
mends the first two: it counts the casters between the near plane and the light, seen from there
through the plane [Hornus et al. 2005]. The other settings are those of [Ergun 2008, section 2.1],
with their faults:

`extrusion` ends the walls: what is farther behind an object than that is lit. `far_plane` = finite
clips what is beyond the camera's: shadows break where a volume goes on. `casters` are the triangles
that make the volumes: `all` takes open shapes, a light within them and triangles turned anyhow;
`light_facing` and `facing_away` make half as many caps, and refuse what is not closed, a ground
among them; so does `shared_edges`.

Spheres, cylinders and disks become meshes of 128 steps around; instances, curves and signed
distances are refused. A pixel takes as long as it has faces before or behind it: shadow rays are
faster where there are many. There is no indirect light, and no derivative of the shadows; other
lights than these three are refused, and cameras that are not perspective.
"""

from functools import partial

from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.check_scenes import beside_a_shadow
from brdfkit.mitsuba_bridge.direct_light import shadowed
from brdfkit.mitsuba_bridge.properties.declarations import flag, plain_number, word
from brdfkit.shadows.volumes.casters import CASTERS
from brdfkit.shadows.volumes.light_volumes import FAR_PLANES, METHODS, LightVolumes
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.seen_faces import pinhole
from brdfkit.shadows.volumes.silhouettes import SILHOUETTES
from brdfkit.shadows.volumes.volume import BACK_CAPS

PARAMETERS = {
    "method": word(METHODS, "which faces count"),
    "near_cap": flag(False, "whether depth_pass begins with what shadows the near plane"),
    "extrusion": plain_number(0.0, (0.0, 1e9), "length of the walls [unit]; 0: without an end"),
    "far_plane": word(FAR_PLANES, "where faces are clipped"),
    "casters": word(CASTERS, "which triangles make the volumes"),
    "silhouettes": word(SILHOUETTES, "how their edges are found"),
    "back_cap": word(BACK_CAPS, "how volumes end"),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class ShadowVolumes(shadowed(mi, PARAMETERS)):
        def shadow_of(self, scene, sensor):
            meshes = [Mesh.of_shape(shape) for shape in scene.shapes()]
            return partial(self.shadow, meshes, sensor)

        def shadow(self, meshes, sensor, emitter):
            """The `LightVolumes` of an `emitter`."""
            return LightVolumes(
                meshes,
                Light.of_emitter(emitter),
                pinhole(sensor),
                self.method,
                self.far_plane,
                max(sensor.film().size()),
                self.near_cap,
                casters=self.casters,
                silhouettes=self.silhouettes,
                length=self.extrusion,
                back_cap=self.back_cap,
            )

    return ShadowVolumes


def reference():
    """See `beside_a_shadow`."""
    return beside_a_shadow({"type": "shadow_volume"})
