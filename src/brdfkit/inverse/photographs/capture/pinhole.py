"""Defines `Pinhole`, the camera of a photograph, which projects points of the sample to pixels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_array
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import make_axes, make_rigid_matrix, project_points

# Near and far clip distance of Mitsuba's camera, as multiples of its height above the sample
CLIP_DISTANCES = 1e-2, 1e4
# Smallest sine of the angle between view direction and `up` for which Mitsuba finds axes
SMALLEST_SINE = 1e-5


@dataclass(frozen=True, eq=False)
class Pinhole:
    """A pinhole camera, whose pictures have no lens distortion.

    Attributes
    ----------
    origin : ndarray, shape (3,)
        The camera's position [m].
    target : ndarray, shape (3,)
        The point in the middle of its pictures [m].
    up : ndarray, shape (3,)
        A direction that points upwards in its pictures.
    fov : float
        The angle across the width of its pictures, between 0 and 180 [degrees].

    Raises
    ------
    BrdfkitError
        For vectors that are not three numbers, a field of view out of range, and a camera that
        looks along `up`.
    """

    origin: FloatArray
    target: FloatArray
    up: FloatArray
    fov: float

    def __post_init__(self) -> None:
        for name in ("origin", "target", "up"):
            object.__setattr__(self, name, to_array(name, getattr(self, name), (3,)))
        object.__setattr__(self, "fov", float(to_array("fov", self.fov, ())))
        check_fov(self.fov)
        away = self.target - self.origin
        along = np.linalg.norm(away) * np.linalg.norm(self.up)
        if not np.linalg.norm(np.cross(away, self.up)) > SMALLEST_SINE * along:
            raise BrdfkitError("camera: it looks along up, or at where it is.")

    @property
    def axes(self) -> FloatArray:
        """The unit vectors (3, 3) that point right, up and backward in a picture, as rows."""
        backward = self.origin - self.target
        return make_axes(backward / np.linalg.norm(backward), self.up / np.linalg.norm(self.up))

    def camera(self, size: tuple[int, int]) -> Camera:
        """Return the camera with projection matrices, for pictures of `size` (2,) in pixels."""
        slope, clips = np.tan(np.radians(self.fov) / 2), self.clips()
        view = make_rigid_matrix(self.axes, self.origin)
        return Camera(view, slope, slope * size[1] / size[0], clips["near_clip"], clips["far_clip"])

    def project(self, points: FloatArray, size: tuple[int, int]) -> FloatArray:
        """Return the places (n, 2) of points (n, 3) [m] in a picture of `size` (width, height).

        Places are columns from the left and rows from the top edge [pixels], nan for points behind
        the camera.
        """
        camera = self.camera(size)
        with np.errstate(divide="ignore", invalid="ignore"):
            x, y, _ = project_points(camera.infinite_projection @ camera.view, points).T
        places = np.stack([(1 + x) / 2 * size[0], (1 - y) / 2 * size[1]], axis=1)
        return np.where(camera.compute_depths(points)[:, None] > 0, places, np.nan)

    def on_sample(self, size: tuple[int, int]) -> FloatArray:
        """Return the point in the plane z = 0 that each pixel of a picture shows.

        The result holds x and y (height, width, 2) [m], inf where a pixel does not show the plane;
        `size` is the picture's width and height [pixels].
        """
        ray = self.camera(size).make_pixel_rays(size)
        steps = np.where(ray[..., 2] < 0, -self.origin[2] / np.minimum(ray[..., 2], -1e-12), np.inf)
        with np.errstate(invalid="ignore"):
            return np.nan_to_num((self.origin + steps[..., None] * ray)[..., :2], nan=np.inf)

    def clips(self) -> dict[str, float]:
        """Return near and far clip distances [m], as Mitsuba's default hides all within 1 cm."""
        height = abs(float(self.origin[2])) or 1.0
        return {"near_clip": CLIP_DISTANCES[0] * height, "far_clip": CLIP_DISTANCES[1] * height}

    def scene_dict(self, size: tuple[int, int]) -> dict[str, Any]:
        """Return the camera as a dictionary for Mitsuba, for pictures of `size` (width, height)."""
        import mitsuba as mi

        at = mi.ScalarTransform4f()
        look = [list(map(float, v)) for v in (self.origin, self.target, self.up)]
        return {
            "type": "perspective",
            "fov": float(self.fov),
            "fov_axis": "x",
            **self.clips(),
            "to_world": at.look_at(*look),
            "film": {
                "type": "hdrfilm",
                "width": int(size[0]),
                "height": int(size[1]),
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
        }


def check_fov(fov: float) -> None:
    """Raise `BrdfkitError` for a field of view that is not between 0 and 180 degrees."""
    if not 0 < fov < 180:
        raise BrdfkitError(f"fov = {fov:g} should be between 0 and 180 degrees.")


def find_corners(size: tuple[float, float]) -> FloatArray:
    """Return the corners (4, 3) [m] of a sample of `size` (2,), clockwise from the upper left."""
    w, h = np.array(size) / 2
    return np.array([[-w, h, 0], [w, h, 0], [w, -h, 0], [-w, -h, 0]])
