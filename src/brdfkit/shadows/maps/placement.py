"""Where a camera, a light and a scene are: what every projection of a shadow map is made from."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.body import Body, make_box
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light


@dataclass(frozen=True)
class Placement:
    """A `camera`, its planes drawn in to the scene, a `light`, and the box `low`, `high` (3,) of
    the `scene`; `nearest`, about the distance of the nearest surface seen, which tunes projections
    and bounds nothing."""

    camera: Camera
    light: Light
    low: np.ndarray
    high: np.ndarray
    nearest: float = 0.0

    @classmethod
    def of_scene(cls, scene, sensor, emitter):
        """Of Mitsuba's objects."""
        bounds = scene.bbox()
        low, high = (np.array(end, float).ravel() for end in (bounds.min, bounds.max))
        if not np.isfinite([low, high]).all():
            raise BrdfkitError("the scene has no shapes that could cast or take a shadow.")
        camera = Camera.from_sensor(sensor).fit_planes(make_box(low, high).corners)
        nearest = nearest_seen(scene, sensor, camera)
        return cls(camera, Light.from_emitter(emitter), low, high, nearest)

    @cached_property
    def scene(self):
        """S, the box of the scene, as far as the light shines: a spot's pyramid bounds it."""
        whole = make_box(self.low, self.high)
        return whole & self.light.bounding_pyramid(self.reach) if self.light.is_bounded else whole

    @property
    def size(self):
        """The diagonal of the scene's box [unit of length]."""
        return float(np.linalg.norm(self.high - self.low))

    @cached_property
    def reach(self):
        """A distance [unit of length] that no ray of light through the scene exceeds."""
        corners = make_box(self.low, self.high).corners
        if self.light.is_directional:
            return self.size
        return float(np.linalg.norm(corners - self.light.point[:3], axis=1).max())

    @cached_property
    def seen(self):
        """V ∩ S, what the camera may see of it."""
        return Body.around(self.camera.corners()) & self.scene

    @cached_property
    def depths(self):
        """z_n and z_f, the distances along the view between which the camera sees something."""
        depths = self.camera.depths(self.seen.corners)
        return min(max(depths.min(), self.nearest), depths.max()), depths.max()

    @cached_property
    def body(self):
        """B = ((V ∩ S) + light) ∩ S: what the camera may see and what may shadow it."""
        return self.seen.extend_to_light(self.light.point, self.size) & self.scene


def nearest_seen(scene, sensor, camera, side=64):
    """The distance along the view of the nearest surface that `side`² rays of a picture hit."""
    import drjit as dr
    import mitsuba as mi

    index = dr.arange(mi.UInt32, side**2)
    place = mi.Point2f(index % side, index // side)
    ray, _ = sensor.sample_ray(0.0, 0.5, (place + 0.5) / side, mi.Point2f(0.5))
    si = scene.ray_intersect(ray)
    seen = np.array(si.is_valid())
    return float(camera.depths(np.array(si.p).T[seen]).min()) if seen.any() else 0.0
