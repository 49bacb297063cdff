"""Tells where on the picture of the ball the camera sees the surface under an angle."""

from __future__ import annotations

import numpy as np

from brdfkit.rendering.scenes._studio import BALL
from brdfkit.viewing.camera import Camera

RADIUS = 1.0  # of the ball [m]


def place_ball(camera: Camera, size: tuple[int, int]) -> dict[str, float]:
    """Return what the page needs to place a mark on the ball, in a picture of a size [pixels].

    "x", "y": the ball's centre, 0 to 1 from the picture's top left. "ratio": the ball's radius over
    its distance: a ray to where the camera sees the surface under an angle θ to the normal is
    asin(ratio · sin θ) from the centre. "across", "down": what share of the picture's width and
    height a ray is from the centre, over the tangent of that angle.
    """
    aspect = size[0] / size[1]
    (x, y, depth), *_ = camera.project(np.array([BALL]), aspect)
    half = np.tan(np.radians(camera.fov / 2))
    shares = {
        "across": 1 / (2 * half * max(aspect, 1.0)),
        "down": 1 / (2 * half * max(1 / aspect, 1.0)),
    }
    return {"x": float(x), "y": float(y), "ratio": float(RADIUS / depth)} | {
        name: float(share) for name, share in shares.items()
    }
