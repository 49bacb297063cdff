"""Techniques that look up no map: volumes of the meshes, and volumes from a depth map."""

from collections.abc import Callable
from dataclasses import replace

from brdfkit.core.projective.camera import Camera
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.hybrid import volumes_of_map
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.volumes.light_volumes import LightVolumes
from brdfkit.shadows.volumes.projected_faces import to_pinhole

JUMP = 8.0  # the integrator's default: change of depth at a silhouette [width of a texel]


def shadow_volume(view: LitView, placement: Placement, resolution: int) -> LightVolumes:
    """Make the shadow volumes of all shapes, which are right but for borders.

    `resolution` has no effect.
    """
    camera = camera_of(view, placement)
    return LightVolumes(view.meshes, placement.light, camera, pixels=max(view.size))


def hybrid_shadow(view: LitView, placement: Placement, resolution: int) -> LightVolumes:
    """Make the shadow volumes from a depth map with `resolution` texels along a side."""
    camera = camera_of(view, placement)
    return volumes_of_map(view.scene, placement, camera, resolution, JUMP, max(view.size))


WITHOUT_MAPS: dict[str, Callable[..., LightVolumes]] = {
    "shadow_volume": shadow_volume,
    "hybrid_shadow": hybrid_shadow,
}


def camera_of(view: LitView, placement: Placement) -> Camera:
    """Return the view's camera at the place of the placement's, with its own near and far planes.

    The near plane of the placement is drawn in to the scene, and walls before it count, too.
    """
    return replace(to_pinhole(view.sensor), view=placement.camera.view)
