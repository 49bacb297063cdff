"""Parallel-split shadow maps (PSSM): a map for each slice of the camera's view, by depth.

`split_planes.py` places the planes between the slices. Near slices are small, and so their maps
have finer texels: with m slices and logarithmic planes from the depth n to f, texels shrink to
about m (n/f)^(1 - 1/m) of the size on a single map [Zhang et al. 2006]. Each slice has a projection
of its own. With the projection `uniform` all maps would be the same; all others gain.

The setting `ends` determines the depths n and f. By default they are those of the nearest and the
farthest surface that the camera sees (sample distribution shadow maps, [Lauritzen et al. 2011]).
With `camera` they are the camera's near and far plane, moved in to the box of the scene. That box
often begins at the eye: then n is Mitsuba's near plane, 0.01, and slices are wasted on the air
before the first surface.

The partition is good for wide scenes. As the camera turns, slices and texels change, so the borders
of shadows crawl; `stable_cascades` avoids this.
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
MARGIN = 0.05  # share of a depth by which surfaces between camera rays may be nearer or farther


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
