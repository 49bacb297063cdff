"""Techniques that look up no map: volumes of the meshes, and volumes out of a depth map."""

from dataclasses import replace

from brdfkit.shadows.hybrid import volumes_of_map
from brdfkit.shadows.volumes.light_volumes import LightVolumes
from brdfkit.shadows.volumes.seen_faces import pinhole

JUMP = 8.0  # change of depth at a silhouette [width of a texel], as the integrator has it


def shadow_volume(seen, placement, resolution):
    """The `LightVolumes` of all shapes; right but for borders. Of no `resolution`."""
    return LightVolumes(
        seen.meshes, placement.light, camera_of(seen, placement), pixels=max(seen.size)
    )


def hybrid_shadow(seen, placement, resolution):
    """The `LightVolumes` out of a depth map with `resolution` texels along a side."""
    camera = camera_of(seen, placement)
    return volumes_of_map(seen.scene, placement, camera, resolution, JUMP, max(seen.size))


OTHERS = {"shadow_volume": shadow_volume, "hybrid_shadow": hybrid_shadow}


def camera_of(seen, placement):
    """The camera with its own planes, where that of the `placement` is: its near plane is drawn in
    to the scene, and walls before that count, too."""
    return replace(pinhole(seen.sensor), view=placement.camera.view)
