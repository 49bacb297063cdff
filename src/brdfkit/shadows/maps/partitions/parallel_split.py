"""A map for each slice of what the camera sees, between planes across the view (PSSM).

The planes are those of `split_planes`, which knows three spacings. Near slices are small, so their
texels are: with m slices, and logarithmic planes, texels shrink to m (n/f)^(1 - 1/m) or so of those
of one map [Zhang et al. 2006]. Each slice has a projection of its own, of any kind but `uniform`,
whose maps would be the same.

n and f are of the `surfaces` that the camera sees (sample distribution shadow maps, [Lauritzen et
al. 2011]), or of its own planes, drawn in to the box of the scene. That box often begins at the
eye: then n is Mitsuba's near plane, 0.01, and parts are wasted on the air before the eye.

Good for wide scenes. Slices change as the camera turns, and with them their texels: borders of
shadows crawl (`stable_cascades` do not).
"""

from dataclasses import replace
from itertools import pairwise

from brdfkit.mitsuba_bridge.properties.declarations import word
from brdfkit.shadows.maps import split_planes
from brdfkit.shadows.maps.partition import filled
from brdfkit.shadows.maps.seen_surfaces import seen_surfaces

SETTINGS = {
    **split_planes.SETTINGS,
    "ends": word(("surfaces", "camera"), "what the first and last plane are set to"),
}
ROOM = 0.05  # about the surfaces that rays found, for nearer ones between the rays


def partition(scene, placement, project, resolution, parts, spacing, ends):
    camera = placement.camera
    if ends == "surfaces":
        depths = camera.depths(seen_surfaces(scene, camera).points)
        near, far = (1 - ROOM) * depths.min(), (1 + ROOM) * depths.max()
        camera = camera.with_planes(max(near, camera.near), min(far, camera.far))
    planes = split_planes.split_planes(camera.near, camera.far, parts, spacing)
    slices = [replace(placement, camera=camera.with_planes(*pair)) for pair in pairwise(planes)]
    return filled(slices, project, resolution, split_planes.by_depth(camera, planes))
