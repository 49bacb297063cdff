"""Shadow volume: direct light of point, spot and directional lights, with stencil shadow volumes.

    L = Σ_lights ρ(ω_l, ω_o) cosθ_l E_l V,   V = 1 where a ray enters as many volumes as it leaves

L is the radiance in the direction ω_o to the camera, ρ the BRDF, ω_l the direction of a light, E_l
its irradiance and V its visibility. Before each picture, shapes are extruded to volumes: walls from
their silhouettes away from the light, and caps that close them [Crow 1977]. Each camera ray then
counts the faces of the volumes, as the stencil buffer of a graphics card does for each sample of a
pixel [Heidmann 1991]: the faces in front of the visible point (`depth_pass`) or behind it
(`depth_fail`). Faces that the ray enters count 1, faces that it leaves -1.

`depth_fail` [Everitt & Kilgard 2002] gives the same shadows as rays to the light. `depth_pass` does
so if the camera is not in shadow, the near plane cuts no volume, and no light passes through
surfaces. `near_cap` removes the first two conditions: it counts the casters between the near plane
and the light, rendered from the light through the plane [Hornus et al. 2005]. The other settings
are from [Ergun 2008, section 2.1], with their faults:

`extrusion` is the length of the walls; points that are farther behind an object are lit.
`far_plane` = finite clips volumes at the camera's far plane, and shadows break there. `casters` are
the triangles that make the volumes: `all` takes open shapes, lights inside them and triangles of
any orientation; `light_facing` and `facing_away` make half as many caps, and refuse shapes that are
not closed, such as a ground. `silhouettes` = shared_edges refuses them, too.

Spheres, cylinders and disks become meshes with 128 steps around; instances, curves and signed
distances are refused. The time of a pixel is proportional to its faces: shadow rays are faster
where there are many. There is no indirect light, and no derivative of the shadows. Other kinds of
lights are refused, and cameras that are not perspective.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from brdfkit.core.array_types import FloatArray, MitsubaModule, MitsubaObject
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.check_scenes import make_shadow_scene
from brdfkit.mitsuba_bridge.direct_light import derive_shadow_integrator
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_bool,
    declare_choice,
    declare_float,
)
from brdfkit.shadows.volumes.casters import CASTERS
from brdfkit.shadows.volumes.light_volumes import FAR_PLANES, METHODS, LightVolumes
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.projected_faces import make_pinhole_camera
from brdfkit.shadows.volumes.silhouettes import SILHOUETTES
from brdfkit.shadows.volumes.volume import BACK_CAPS

PARAMETERS = {
    "method": declare_choice(METHODS, "which faces count"),
    "near_cap": declare_bool(False, "whether depth_pass starts with the shadows on the near plane"),
    "extrusion": declare_float(0.0, (0.0, 1e9), "length of the walls [unit]; 0: infinite"),
    "far_plane": declare_choice(FAR_PLANES, "where faces are clipped"),
    "casters": declare_choice(CASTERS, "which triangles make the volumes"),
    "silhouettes": declare_choice(SILHOUETTES, "how their silhouettes are found"),
    "back_cap": declare_choice(BACK_CAPS, "how volumes end"),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_shadow_integrator(mi, PARAMETERS)

    class ShadowVolumes(Base):
        def prepare_shadows(
            self, scene: MitsubaObject, sensor: MitsubaObject
        ) -> Callable[[MitsubaObject], LightVolumes]:
            meshes = [Mesh.from_shape(shape) for shape in scene.shapes()]
            return partial(self.make_light_volumes, meshes, sensor)

        def make_light_volumes(
            self, meshes: Sequence[Mesh], sensor: MitsubaObject, emitter: MitsubaObject
        ) -> LightVolumes:
            """Make the shadow volumes of all meshes for one `emitter` of the scene."""
            return LightVolumes(
                meshes,
                Light.from_emitter(emitter),
                make_pinhole_camera(sensor),
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


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene with a shadow, and the radiance (3,) that its picture should have."""
    return make_shadow_scene({"type": "shadow_volume"})
