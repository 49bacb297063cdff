"""Where a camera, a light and a scene are: what every projection of a shadow map is made from."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.projective.body import Body, box
from brdfkit.projective.camera import Camera
from brdfkit.projective.light import Light


@dataclass(frozen=True)
class Placement:
    """A `camera`, its planes drawn in to the scene, a `light`, and the box `low`, `high` (3,) of
    the `scene`."""

    camera: Camera
    light: Light
    low: np.ndarray
    high: np.ndarray

    @classmethod
    def of_scene(cls, scene, sensor, emitter):
        """Of Mitsuba's objects."""
        bounds = scene.bbox()
        low, high = (np.array(end, float).ravel() for end in (bounds.min, bounds.max))
        camera = Camera.of_sensor(sensor).fitted(box(low, high).corners)
        return cls(camera, Light.of_emitter(emitter), low, high)

    @cached_property
    def scene(self):
        """S, the box of the scene, as far as the light shines: a spot's pyramid bounds it."""
        whole = box(self.low, self.high)
        return whole if self.light.axis is None else whole & self.light.pyramid(self.reach)

    @cached_property
    def reach(self):
        """A distance [unit of length] that no ray of light through the scene exceeds."""
        corners = box(self.low, self.high).corners
        if self.light.is_directional:
            return float(np.linalg.norm(self.high - self.low))
        return float(np.linalg.norm(corners - self.light.point[:3], axis=1).max())

    @cached_property
    def seen(self):
        """V ∩ S, what the camera may see of it."""
        return Body.around(self.camera.corners()) & self.scene

    @cached_property
    def body(self):
        """B = ((V ∩ S) + light) ∩ S: what the camera may see and what may shadow it."""
        return self.seen.towards(self.light, self.reach) & self.scene
