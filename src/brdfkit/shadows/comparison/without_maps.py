"""The techniques in a comparison that make shadow volumes, from meshes or from a depth map."""

from collections.abc import Callable
from dataclasses import replace

from brdfkit.core.projective.camera import Camera
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.hybrid import make_volumes_from_depth_map
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.volumes.light_volumes import LightVolumes
from brdfkit.shadows.volumes.projected_faces import make_pinhole_camera

JUMP = 8.0  # least change of depth at a silhouette [widths of a texel], as in `hybrid_shadow`


def make_mesh_volumes(view: LitView, placement: Placement, resolution: int) -> LightVolumes:
    """Make the shadow volumes of all shapes in a view.

    `resolution` has no effect, but all techniques take it.
    """
    camera = place_camera(view, placement)
    return LightVolumes(view.meshes, placement.light, camera, pixels=max(view.size))


def make_depth_map_volumes(view: LitView, placement: Placement, resolution: int) -> LightVolumes:
    """Make the shadow volumes of a depth map with `resolution` texels along a side."""
    camera = place_camera(view, placement)
    return make_volumes_from_depth_map(
        view.scene, placement, camera, resolution, JUMP, max(view.size)
    )


WITHOUT_MAPS: dict[str, Callable[..., LightVolumes]] = {
    "shadow_volume": make_mesh_volumes,
    "hybrid_shadow": make_depth_map_volumes,
}


def place_camera(view: LitView, placement: Placement) -> Camera:
    """Return the view's camera, moved to the camera of a placement, for counting volumes.

    It keeps its own near plane: the placement's is moved in to the scene, but the walls of shadow
    volumes before the scene count, too.
    """
    return replace(make_pinhole_camera(view.sensor), view=placement.camera.view)
