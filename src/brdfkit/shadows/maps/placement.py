"""`Placement`: where the camera, the light and the scene are, for making shadow-map projections."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import AnyArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.body import Body, make_box
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light


@dataclass(frozen=True)
class Placement:
    """The geometry from which a shadow map's projection is made: camera, light and scene's box.

    camera : the camera, with near and far planes moved in to the scene.
    light : a point, spot or directional light.
    low, high : two opposite corners (3,) of the scene's bounding box.
    nearest : approximate depth of the nearest visible surface, for which projections are tuned;
        there may be slightly nearer surfaces.
    """

    camera: Camera
    light: Light
    low: AnyArray
    high: AnyArray
    nearest: float = 0.0

    @classmethod
    def from_scene(
        cls, scene: MitsubaObject, sensor: MitsubaObject, emitter: MitsubaObject
    ) -> "Placement":
        """Return the placement of a Mitsuba sensor and emitter in a scene."""
        bounds = scene.bbox()
        low, high = (np.array(end, float).ravel() for end in (bounds.min, bounds.max))
        if not np.isfinite([low, high]).all():
            raise BrdfkitError("the scene has no shapes: add some that cast and take shadows.")
        camera = Camera.from_sensor(sensor).fit_near_and_far(make_box(low, high).corners)
        nearest = find_nearest_depth(scene, sensor, camera)
        return cls(camera, Light.from_emitter(emitter), low, high, nearest)

    @cached_property
    def lit_body(self) -> Body:
        """The part of the scene's box that the light can reach; a spot's pyramid cuts the box."""
        whole = make_box(self.low, self.high)
        light = self.light
        return whole & light.make_bounding_pyramid(self.reach) if light.is_bounded else whole

    @property
    def scene_diagonal(self) -> float:
        """The diagonal of the scene's box [unit of length]."""
        return float(np.linalg.norm(self.high - self.low))

    @cached_property
    def reach(self) -> float:
        """An upper bound on the length of light rays through the scene [unit of length]."""
        corners = make_box(self.low, self.high).corners
        if self.light.is_directional:
            return self.scene_diagonal
        return float(np.linalg.norm(corners - self.light.point[:3], axis=1).max())

    @cached_property
    def visible_body(self) -> Body:
        """The part of `lit_body` that is in the camera's frustum."""
        return Body.from_points(self.camera.find_frustum_corners()) & self.lit_body

    @cached_property
    def visible_depths(self) -> tuple[float, float]:
        """The least and the greatest depth, along the camera's view, of visible surfaces."""
        depths = self.camera.compute_depths(self.visible_body.corners)
        return min(max(depths.min(), self.nearest), depths.max()), depths.max()

    @cached_property
    def relevant_body(self) -> Body:
        """What the camera may see of the scene, and what may cast shadows on it.

        It is the convex hull of `visible_body` and the light, within `lit_body`.
        """
        return (
            self.visible_body.extend_to_light(self.light.point, self.scene_diagonal) & self.lit_body
        )


def find_nearest_depth(
    scene: MitsubaObject, sensor: MitsubaObject, camera: Camera, side: int = 64
) -> float:
    """Return the least depth, along the camera's view, of the surfaces that `side`² rays hit.

    It is 0 if all rays miss.
    """
    import drjit as dr
    import mitsuba as mi

    index = dr.arange(mi.UInt32, side**2)
    place = mi.Point2f(index % side, index // side)
    ray, _ = sensor.sample_ray(0.0, 0.5, (place + 0.5) / side, mi.Point2f(0.5))
    si = scene.ray_intersect(ray)
    hit = np.array(si.is_valid())
    return float(camera.compute_depths(np.array(si.p).T[hit]).min()) if hit.any() else 0.0
