"""`MaterialScene`: a shape of one material in Mitsuba, whose camera moves without a new kernel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.previewing.scene import describe_preview
from brdfkit.rendering.progressive import to_rgb
from brdfkit.rendering.scene_input.environment import replace_light
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.rendering.scenes._studio import BALL, CAMERA, FOV, TARGET, make_studio
from brdfkit.rendering.volumes.camera import to_direction
from brdfkit.viewing.camera import Camera
from brdfkit.viewing.materials.live_light import LiveLight

PLANE = "plane"  # the name of the shape that is a level square
SIDE = 2.0  # of the plane [m], the diameter of the ball
LAMP_AZIMUTH, LAMP_ELEVATION = -54.0, 39.0  # of the lamp at first, seen from the ball [degrees]
LAMP_DISTANCE = 7.0  # from the middle of the ball [m]
RAYS = 4  # per pixel of a picture without noise


@dataclass(frozen=True)
class SceneKind:
    """Everything about a scene that needs a kernel of its own; all else is a parameter.

    `shape`: the name of a scene under the sky, a mesh's file, or `PLANE`. `light`: the name of an
    environment map, its file, or `LAMP`. `size`: (width, height) [pixels]. `moving`: whether the
    picture is to be without noise at once; it then lacks the light between surfaces. `ground`:
    whether the shape stands on the ground, which only pictures at rest show.
    """

    shape: str
    light: str
    size: tuple[int, int]
    moving: bool
    ground: bool = False


@dataclass(frozen=True)
class Look:
    """What changes without a new kernel, besides the material.

    `camera`: the camera. `turn`: rotation of the environment about the vertical axis [degrees].
    `lamp`: the place (3,) of the lamp [m].
    """

    camera: Camera
    turn: float = 0.0
    lamp: tuple[float, float, float] = (-4.4, -3.2, 5.4)


class MaterialScene:
    """A scene of Mitsuba for a kind, a BSDF and a light, which other scenes may share."""

    def __init__(self, kind: SceneKind, bsdf: MitsubaObject, light: LiveLight) -> None:
        import mitsuba as mi

        self.kind, self.light = kind, light
        built = find_shape(kind.shape)(bsdf, kind.size)
        if kind.moving:
            described = describe_preview(built, light.emitter, light.noise_free, RAYS)
        else:
            described = replace_light(light.emitter, built) | {"integrator": light.traced}
            if not kind.ground:
                described.pop("ground")
        self.scene = load_by_mitsuba(mi.load_dict, described, kind.shape)
        self.parameters = mi.traverse(self.scene)
        self.camera: Camera | None = None

    def render(self, look: Look, seed: int) -> AnyArray:
        """Render a pass: (height, width, 3), linear sRGB.

        While something moves it has `RAYS` samples per pixel, whatever the seed, otherwise one.
        """
        import mitsuba as mi

        self.light.show(look.turn, np.asarray(look.lamp))
        self._place(look.camera)
        seed, spp = (0, RAYS) if self.kind.moving else (seed, 1)
        with raise_first_cause():
            integrator = self.scene.integrator()
            picture = to_rgb(integrator.render(self.scene, seed=mi.UInt32(seed), spp=spp))
        if not self.kind.moving:
            self.light.count_picture()
        return picture

    def find_directions(self, look: Look) -> tuple[AnyArray, AnyArray]:
        """Return the directions to the camera and to the lamp, nan beside the shape.

        Both are (height, width, 3), about the normal z of the place that a pixel's middle shows.
        """
        import drjit as dr
        import mitsuba as mi

        width, height = self.kind.size
        x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
        origin, directions = look.camera.cast_ray(x.ravel(), y.ravel(), width / height)
        ray = mi.Ray3f(mi.Point3f(*map(float, origin)), mi.Vector3f(directions.T))
        si = self.scene.ray_intersect(ray)
        towards = si.to_local(dr.normalize(mi.Point3f(*look.lamp) - si.p))
        hit = np.array(si.is_valid())[:, None]
        view, light = (np.where(hit, np.array(w).T, np.nan) for w in (si.wi, towards))
        return view.reshape(height, width, 3), light.reshape(height, width, 3)

    def _place(self, camera: Camera) -> None:
        """Place the camera."""
        import drjit as dr
        import mitsuba as mi

        if camera == self.camera:
            return
        fov = mi.Float(camera.horizontal_fov(self.kind.size[0] / self.kind.size[1]))
        dr.make_opaque(fov)
        self.parameters["sensor.x_fov"] = fov
        self.parameters["sensor.to_world"] = mi.Transform4f(camera.to_world.astype(np.float32))
        self.parameters.update()
        self.camera = camera


def find_shape(shape: str) -> Callable[..., dict[str, Any]]:
    """Return the function (bsdf, size) that makes the dictionary of a scene with the shape.

    Raises `BrdfkitError` for a shape that does not exist.
    """
    if shape == PLANE:
        return make_plane
    path = Path(shape.partition("#")[0])
    return _find_scene(shape, path.stat().st_mtime_ns if path.is_file() else None)


@lru_cache(maxsize=4)
def _find_scene(shape: str, changed: int | None) -> Callable[..., dict[str, Any]]:
    """Return the function of a scene or a mesh, and keep the mesh in memory.

    `changed`, the time of change of the mesh's file, is a key of the cache only.
    """
    return find_scene(shape)


def make_plane(bsdf: MitsubaObject, size: tuple[int, int] = (512, 512)) -> dict[str, Any]:
    """Return the dictionary of a scene with a level square, whose sides are along x and y."""
    import mitsuba as mi

    to_world = mi.ScalarTransform4f().translate(list(TARGET)).scale(SIDE / 2)
    return make_studio(size) | {"plane": {"type": "rectangle", "to_world": to_world, "bsdf": bsdf}}


def place_lamp(azimuth: float, elevation: float) -> tuple[float, float, float]:
    """Return the place (3,) of the lamp [m] by its angles [degrees], seen from the ball."""
    x, y, z = np.add(BALL, LAMP_DISTANCE * to_direction(azimuth, elevation))
    return float(x), float(y), float(z)


def find_lamp(look: Look, size: tuple[int, int]) -> tuple[float, float, bool]:
    """Return where the ball faces the lamp: 0 to 1 from the picture's top left, and if it is seen.

    `size` is that of the picture [pixels].
    """
    towards = np.subtract(look.lamp, BALL) / LAMP_DISTANCE
    ((x, y, depth),) = look.camera.project(np.add(BALL, towards)[None], size[0] / size[1])
    ((*_, middle),) = look.camera.project(np.asarray(BALL)[None], 1.0)
    return float(x), float(y), bool(depth < middle)


def make_studio_camera() -> Camera:
    """Return the camera of brdfkit's scenes."""
    towards: FloatArray = np.subtract(CAMERA, TARGET)
    distance = float(np.linalg.norm(towards))
    elevation = float(np.degrees(np.arcsin(towards[2] / distance)))
    return Camera(0.0, elevation, distance, FOV, TARGET)
