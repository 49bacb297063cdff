"""A camera that moves a little from picture to picture, as in a game: what makes shadows swim."""

from dataclasses import replace

import numpy as np

from brdfkit.projective.homogeneous import rigid

STEPS = 4
TURN, WAY = 0.01, 0.003  # a step's turn to the right [rad], and its way over the size of the scene


def path(placement, steps=STEPS):
    """The `Placement`s of a camera that goes to the right, and turns that way, in equal steps."""
    camera = placement.camera
    found = []
    for step in range(steps):
        angle, way = TURN * step, WAY * step * placement.size
        turn = np.array(
            [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
        )
        moved = rigid(turn, np.array([way, 0, 0])) @ camera.view
        found.append(replace(placement, camera=replace(camera, view=moved)))
    return found
