"""A map for each slice of the camera's view, between planes across the view (PSSM).

The planes are those of `split_planes`, which has three spacings. Near slices are small, and so are
their texels: with m slices and logarithmic planes from n to f, texels shrink to about m (n/f)^(1 -
1/m) of those of one map [Zhang et al. 2006]. Each slice has a projection of its own. All
projections but `uniform` gain by it; with `uniform` all maps would be the same.

n and f are the depths of the nearest and farthest `surfaces` that the camera sees (sample
distribution shadow maps, [Lauritzen et al. 2011]), or of the `camera`'s own planes, moved in to the
box of the scene. That box often begins at the eye: then n is Mitsuba's near plane, 0.01, and parts
are wasted on the air before the first surface.

The partition is good for wide scenes. Slices change as the camera turns, and with them their
texels: borders of shadows crawl (those of `stable_cascades` do not).
"""

from dataclasses import replace
from itertools import pairwise

from brdfkit.mitsuba_bridge.properties.declarations import declare_choice
from brdfkit.shadows.maps import split_planes
from brdfkit.shadows.maps.partition import Partition, Setup, make_partition_from_placements
from brdfkit.shadows.maps.visible_surfaces import find_visible_surfaces

SETTINGS = {
    **split_planes.SETTINGS,
    "ends": declare_choice(("surfaces", "camera"), "what the first and last plane are set to"),
}
MARGIN = 0.05  # share of the depths; surfaces between the rays may be nearer or farther by it


def make_partition(setup: Setup, parts: int, spacing: str, ends: str) -> Partition:
    """Make a partition of at most `parts` slices of the camera's view."""
    camera = setup.placement.camera
    if ends == "surfaces":
        depths = camera.compute_depths(find_visible_surfaces(setup.scene, camera).points)
        near, far = (1 - MARGIN) * depths.min(), (1 + MARGIN) * depths.max()
        camera = camera.replace_near_and_far(max(near, camera.near), min(far, camera.far))
    planes = split_planes.compute_split_planes(camera.near, camera.far, parts, spacing)
    cameras = [camera.replace_near_and_far(*pair) for pair in pairwise(planes)]
    slices = [replace(setup.placement, camera=each) for each in cameras]
    return make_partition_from_placements(
        setup, slices, split_planes.make_slice_finder(camera, planes)
    )
