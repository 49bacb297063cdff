"""Tracks surface points while the camera or the light moves a little, to measure flicker.

Such moves, as in a game, make the borders of shadows jump from texel to texel.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, MitsubaObject
from brdfkit.core.projective.homogeneous import make_rigid_matrix, project_points
from brdfkit.core.projective.light import Light
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.comparison.quality import measure_flicker
from brdfkit.shadows.maps.placement import Placement

PIXEL_STRIDE = 7  # every seventh pixel is tracked
STEPS = 4  # number of pictures on a path, the first of which is the view itself
CAMERA_TURN = 0.003  # angle by which the camera turns between two pictures [rad]
CAMERA_STEP = 0.01  # the camera's move between two pictures, divided by the least visible depth
LIGHT_TURN = 0.01  # the light's move between two pictures, seen from the scene's far end [rad]


@dataclass(frozen=True)
class TrackedPoints:
    """Points of surfaces at rest, seen while the camera or the light moves along a path.

    view : the view in the first picture.
    pixels : indices of the pixels of `view` that show the points.
    path : placement of the camera and the light in each picture.
    true : whether the light arrives at each point, (pictures, points); from shadow rays.
    """

    view: LitView
    pixels: AnyArray
    path: list[Placement]
    true: AnyArray

    @classmethod
    def by_moving_camera(cls, view: LitView, placement: Placement) -> "TrackedPoints":
        """Return points of a view that a camera on a path always sees, in a light at rest."""
        path, pixels = make_camera_path(placement), np.flatnonzero(view.facing)[::PIXEL_STRIDE]
        pixels = pixels[is_visible_to_all_cameras(path, np.array(view.si.p).T[pixels])]
        return cls(view, pixels, path, np.tile(view.exact[pixels], (len(path), 1)))

    @classmethod
    def by_moving_light(cls, view: LitView, placement: Placement) -> "TrackedPoints":
        """Return points of a view that always face a light on a path, with the camera at rest."""
        path, pixels = make_light_path(placement), np.flatnonzero(view.facing)[::PIXEL_STRIDE]
        points, normals = (np.array(vectors).T[pixels] for vectors in (view.si.p, view.si.n))
        pixels = pixels[is_facing_all_lights(path, points, normals)]
        p, n = view.gather_points(pixels)
        true = [is_lit(view.scene, each.light, p, n) for each in path]
        return cls(view, pixels, path, np.array(true))

    def measure_flicker(
        self, lit: FloatArray, technique: Callable[[LitView, Placement], Any]
    ) -> float:
        """Return the mean change of a technique's error between pictures; NaN without points.

        lit : share (pixels,) of the light that arrives in the first picture, with the technique.
        technique : function that makes a shadow, an object with `visibility(p, n)` such as
            `LightShadow`.
        """
        if not self.pixels.size:
            return nan
        p, n = self.view.gather_points(self.pixels)
        later = [np.array(technique(self.view, each).visibility(p, n)) for each in self.path[1:]]
        return measure_flicker([lit[self.pixels], *later], self.true)


def make_camera_path(placement: Placement) -> list[Placement]:
    """Return placements in which the camera moves and turns step by step, to measure flicker.

    A step shifts a picture that is 512 pixels wide by two or three pixels.
    """
    camera = placement.camera
    nearest, _ = placement.visible_depths
    path = []
    for step in range(STEPS):
        c, s = np.cos(CAMERA_TURN * step), np.sin(CAMERA_TURN * step)
        turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        moved = make_rigid_matrix(turn, [CAMERA_STEP * step * nearest, 0, 0]) @ camera.view
        path.append(replace(placement, camera=replace(camera, view=moved)))
    return path


def is_visible_to_all_cameras(placements: list[Placement], points: FloatArray) -> BoolArray:
    """Return whether each of the points (n, 3) is within the picture of every camera, (n,)."""
    matrices = [placement.camera.matrix for placement in placements]
    within = [(np.abs(project_points(m, points)) <= 1).all(axis=1) for m in matrices]
    visible: BoolArray = np.all(within, axis=0)
    return visible


def make_light_path(placement: Placement) -> list[Placement]:
    """Return placements in which the light moves step by step, to measure flicker.

    The steps are equal, and at right angles to the light's rays; the first placement is unchanged.
    """
    light = placement.light
    way = light.point[:3] - light.point[3] * placement.visible_body.centroid
    step = LIGHT_TURN * unit_perpendicular(way) * (1 if light.is_directional else placement.reach)
    return [replace(placement, light=move_light(light, k * step)) for k in range(STEPS)]


def unit_perpendicular(way: FloatArray) -> FloatArray:
    """Return a unit vector (3,) at right angles to the vector `way` (3,)."""
    way = way / max(float(np.linalg.norm(way)), 1e-9)
    across: FloatArray = np.eye(3)[np.argmin(np.abs(way))]
    across = across - (across @ way) * way
    return across / np.linalg.norm(across)


def move_light(light: Light, step: FloatArray) -> Light:
    """Return a light whose position is moved by a vector `step` (3,).

    A directional light has no position: the `step` is added to the unit vector towards it.
    """
    place = light.point[:3] + step
    if light.is_directional:
        place = place / np.linalg.norm(place)
    return replace(light, point=np.append(place, light.point[3]))


def is_facing_all_lights(
    placements: list[Placement], points: FloatArray, normals: FloatArray
) -> BoolArray:
    """Return whether the lights of all placements are on one side of each surface point, (n,).

    points, normals : the points and their normals (n, 3).
    """
    to_lights = (each.light.directions_to_light(points) for each in placements)
    cosines = [(normals * to_light).sum(axis=1) for to_light in to_lights]
    facing: BoolArray = (np.min(cosines, axis=0) > 0) | (np.max(cosines, axis=0) < 0)
    return facing


def is_lit(scene: MitsubaObject, light: Light, p: MitsubaObject, n: MitsubaObject) -> BoolArray:
    """Return whether shadow rays from points `p` with normals `n` reach a light, (points,)."""
    import drjit as dr
    import mitsuba as mi

    surface = dr.zeros(mi.Interaction3f, dr.width(p))
    surface.p, surface.n = p, n
    place = light.point[:3].tolist()
    if light.is_directional:
        ray = surface.spawn_ray(dr.opaque(mi.Vector3f, place))
    else:
        ray = surface.spawn_ray_to(dr.opaque(mi.Point3f, place))
    return np.array(~scene.ray_test(ray))
