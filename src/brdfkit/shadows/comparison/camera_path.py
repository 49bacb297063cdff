"""A camera that moves a little from picture to picture, as in a game: what makes shadows swim."""

from dataclasses import replace

import numpy as np

from brdfkit.core.projective.homogeneous import make_rigid, project_all

STEPS = 4
TURN, WAY = 0.003, 0.01  # a step's turn to the right [rad], and its way over the nearest distance


def path(placement, steps=STEPS):
    """The `Placement`s of a camera that goes to the right, and turns that way, in equal steps.

    A step moves a picture of 512 pixels by two or three of them.
    """
    camera = placement.camera
    nearest, _ = placement.depths
    found = []
    for step in range(steps):
        c, s = np.cos(TURN * step), np.sin(TURN * step)
        turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        moved = make_rigid(turn, np.array([WAY * step * nearest, 0, 0])) @ camera.view
        found.append(replace(placement, camera=replace(camera, view=moved)))
    return found


def seen_by_all(placements, points):
    """Whether (n,) points (n, 3) are within the pictures of all cameras."""
    matrices = [placement.camera.matrix for placement in placements]
    return np.all([(np.abs(project_all(m, points)) <= 1).all(axis=1) for m in matrices], axis=0)
