"""Makes a compact scene, all of whose objects are seen: seven on a ground of 8 × 8.

The other scenes are deep or full: most of their shadow maps is never seen.
"""

import numpy as np

from brdfkit.shadows.maps.scenes._stage import (
    make_camera_and_sun,
    make_ground,
    name_shapes_by_number,
)
from brdfkit.shadows.maps.scenes.objects_on_a_ground import COLOURS, make_bricks

HALF, RING, SEED = 4, 2.4, 2008  # half the ground's side; radius of the ring of six objects
DOWN, FOV = 28, 60  # degrees: how far the camera looks down, and its field of view


def make_compact_scene(distance):
    """Return a function that makes the scene as those of `SCENES`, from a distance of the eye."""

    def make_scene(view="V1", light=1, size=(512, 512)):
        random, angles = np.random.default_rng(SEED), np.arange(6) * np.pi / 3
        places = [np.zeros(2), *RING * np.column_stack([np.cos(angles), np.sin(angles)])]
        bricks = [
            make_bricks(random, place, COLOURS[i % len(COLOURS)]) for i, place in enumerate(places)
        ]

        def place_eye(azimuth):
            level, up = distance * np.cos(np.radians(DOWN)), distance * np.sin(np.radians(DOWN))
            return -level * np.sin(azimuth), -level * np.cos(azimuth), up

        return (
            make_camera_and_sun(view, light, size, place_eye, down=DOWN, fov=FOV)
            | {"floor": make_ground(HALF, (0.62, 0.6, 0.56))}
            | name_shapes_by_number("brick", [shape for shapes in bricks for shape in shapes])
        )

    return make_scene
