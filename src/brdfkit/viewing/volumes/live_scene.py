"""`LiveScene`: a volume in Mitsuba whose view changes by parameters alone, without a new kernel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.core.jit.padding import pad
from brdfkit.rendering.progressive import to_rgb
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scenes._studio import make_camera
from brdfkit.rendering.volumes.scene import (
    ILLUMINANCES,
    LEAST_STEPS,
    RENDERERS,
    UNLIT,
    describe_renderer,
)
from brdfkit.viewing.camera import Camera
from brdfkit.viewing.volumes.live_volume import LiveVolume
from brdfkit.volumes import Volume

PHASES: dict[str, dict[str, Any]] = {
    "henyey_greenstein": {"type": "hg", "g": 0.0},
    "rayleigh": {"type": "rayleigh"},
    "schlick": {"type": "schlick", "k": 0.0},
    "mie_hazy": {"type": "mie_hazy"},
    "mie_murky": {"type": "mie_murky"},
}


@dataclass(frozen=True)
class SceneKind:
    """Everything about a scene that needs a kernel of its own; all else is a parameter.

    `renderer`: one of `RENDERERS`. `size`: (width, height) [pixels]. `steps`: parts that a ray is
    cut into. `by_gradients`: whether the transfer function depends on gradient magnitudes.
    `colour`: whether its RGB is an "albedo" or an "emission". `phase`: one of `PHASES`.
    `max_depth`: largest number of segments of a path. `sun`: whether there is a sun.
    `shows_environment`: whether the camera sees the environment map.
    """

    renderer: str
    size: tuple[int, int]
    steps: int
    by_gradients: bool = False
    colour: str = "albedo"
    phase: str = "henyey_greenstein"
    max_depth: int = 2
    sun: bool = False
    shows_environment: bool = False


@dataclass(frozen=True, eq=False)
class Look:
    """The parameters of a `LiveScene`, each of which changes without a new kernel.

    `camera`: the camera. `table`: RGBA of the transfer function, (VALUE_ROWS, 4) or
    (GRADIENT_ROWS, VALUE_ROWS, 4). `extinction`: σ where A is 1 [1/unit of length]. `level`: the
    value of the surface. `surface`: its reflectance (3,), linear sRGB. `asymmetry`: g, or Schlick's
    k, of the phase function. `clip`: the corners (2, 3) of the visible part, in the unit
    cube. `background`: radiance (3,) behind the volume. `environment`: name or file of the map.
    `turn`: its rotation about the vertical axis [degrees]. `brightness`: a factor of its light.
    `sun`: irradiance (3,) of the sun. `sun_direction`: the unit vector (3,) towards the sun.
    """

    camera: Camera
    table: AnyArray
    extinction: float
    level: float
    surface: FloatArray
    asymmetry: float
    clip: FloatArray
    background: FloatArray
    environment: str
    turn: float
    brightness: float
    sun: FloatArray
    sun_direction: FloatArray


class LiveScene:
    """A Mitsuba scene of a volume; `show` changes its parameters, and `render` renders a pass.

    `environments` are maps by name, besides those that brdfkit knows.
    """

    def __init__(
        self,
        volume: LiveVolume,
        kind: SceneKind,
        environments: Mapping[str, AnyArray] = MappingProxyType({}),
    ) -> None:
        import mitsuba as mi

        use_variant()
        self.volume, self.kind, self.environments = volume, kind, environments
        self.prefix = f"integrator.{RENDERERS[kind.renderer]}"
        self.shown: dict[str, Any] = {}  # the parameters as they are
        self.map_name, self.map_data = "", np.zeros(0)  # the environment map as it is
        # In parallel, Mitsuba 3.9 keeps 0.3 MB of each scene for ever
        self.scene = mi.load_dict(self._describe(), parallel=False)
        self.parameters = mi.traverse(self.scene)

    def _describe(self) -> dict[str, Any]:
        """Return the dictionary of the scene; its parameters are only placeholders."""
        kind = self.kind
        contents = self.volume.describe(kind.by_gradients, kind.colour)
        entries = describe_renderer(kind.renderer, contents, kind.steps)
        if kind.renderer == "single_scattering":
            entries |= {"phase": PHASES[kind.phase], "max_depth": kind.max_depth}
        if kind.renderer == "isosurface":
            entries |= {"surface_of": "values", "level": 0.5}
        if not kind.shows_environment or kind.renderer in UNLIT:
            entries["background"] = {"type": "rgb", "value": [0.0, 0.0, 0.0]}
        scene: dict[str, Any] = {
            "type": "scene",
            "integrator": entries,
            "sensor": make_camera((0, -1, 0), (0, 0, 0), 25.0, kind.size) | self._clip(),
        }
        if kind.renderer in UNLIT:
            return scene
        scene["sky"] = describe_environment("studio") | {"scale": 1.0}
        if kind.sun:
            rgb = {"type": "rgb", "value": [0.0, 0.0, 0.0]}
            scene["sun"] = {"type": "directional", "direction": [0, 0, -1], "irradiance": rgb}
        return scene

    def _clip(self) -> dict[str, float]:
        """Return clipping distances for any view: they are written into the kernels."""
        low, high = self.volume.volume.bounds
        diagonal = float(np.linalg.norm(high - low))
        return {"near_clip": 1e-4 * diagonal, "far_clip": 1e4 * diagonal}

    def show(self, look: Look) -> None:
        """Change the parameters that differ from the last `look`."""
        kind, camera = self.kind, look.camera
        new: dict[str, Any] = {
            "sensor.to_world": camera.to_world,
            "sensor.x_fov": camera.horizontal_fov(kind.size[0] / kind.size[1]),
            f"{self.prefix}.clip_low": look.clip[0],
            f"{self.prefix}.clip_high": look.clip[1],
            "integrator.background": look.background,
        }
        if kind.renderer != "isosurface":
            new[f"{self.prefix}.table"] = look.table
            new[f"{self.prefix}.extinction"] = look.extinction
        else:
            new["integrator.level"] = self.volume.to_shares(look.level)
            new["integrator.bsdf.diffuse_reflectance.value"] = look.surface
        new["integrator.phase.g"] = new["integrator.phase.k"] = look.asymmetry
        new["sky"], new["sky.turn"] = (look.environment, look.brightness), look.turn
        new["sun.irradiance.value"], new["sun.to_world"] = look.sun, look.sun_direction
        changed = {name: value for name, value in new.items() if self._differs(name, value)}
        for name, value in changed.items():
            self._assign(name, value)
            self.shown[name] = value
        if changed:
            self.parameters.update()

    def _differs(self, name: str, value: Any) -> bool:
        """Return whether a parameter that the scene has differs from `value`."""
        shown = self.shown.get(name)
        if name in ("sky", "sky.turn"):
            return "sky.data" in self.parameters and shown != value
        if name not in self.parameters or shown is value:
            return False
        return shown is None or not np.array_equal(shown, value)

    def _assign(self, name: str, value: Any) -> None:
        """Assign a value to a parameter, in Mitsuba's type."""
        import drjit as dr
        import mitsuba as mi

        if name == "sky":
            self._light(*value)
        elif name == "sky.turn":
            at = mi.Transform4f()
            upright = at.rotate([0, 0, 1], value) @ at.rotate([1, 0, 0], 90)
            self.parameters["sky.to_world"] = upright
        elif name.endswith("to_world"):
            if name.startswith("sun"):
                value = _rotation_from_z(-np.asarray(value))
            self.parameters[name] = mi.Transform4f(np.asarray(value, np.float32))
        elif name.endswith("table"):
            self.parameters[name] = _make_tensor(value)
        else:
            kind = type(self.parameters[name])
            coordinates = np.ravel(value).tolist()
            if kind is float:
                self.parameters[name] = coordinates[0]
                return
            opaque = kind(*coordinates) if len(coordinates) > 1 else kind(coordinates[0])
            dr.make_opaque(opaque)
            self.parameters[name] = opaque

    def _light(self, environment: str, brightness: float) -> None:
        """Light the scene by an environment map."""
        import mitsuba as mi

        if self.map_name != environment:
            described = describe_environment(self.environments.get(environment, environment))
            bitmap = mi.load_dict({"type": "envmap", "bitmap": described["bitmap"]})
            self.map_name = environment
            self.map_data = np.array(mi.traverse(bitmap)["data"]) * described["scale"]
        factor = ILLUMINANCES[self.kind.renderer] * brightness
        self.parameters["sky.data"] = _make_tensor(factor * self.map_data)

    def render(self, seed: int) -> AnyArray:
        """Render one sample per pixel: (height, width, 3), linear sRGB."""
        import mitsuba as mi

        with raise_first_cause():
            picture = self.scene.integrator().render(self.scene, seed=mi.UInt32(seed), spp=1)
            return to_rgb(picture)


def _make_tensor(values: AnyArray) -> Any:
    """Return an array as a tensor of Mitsuba, aligned, so that it needs no kernel of its own."""
    import mitsuba as mi

    flat = np.asarray(values, np.float32).ravel()
    return mi.TensorXf(mi.Float(pad(flat)), values.shape)


def _rotation_from_z(direction: FloatArray) -> FloatArray:
    """Return the rotation (4, 4) that turns z into a unit vector `direction`."""
    helper = np.array([1.0, 0, 0]) if abs(direction[0]) < 0.9 else np.array([0, 1.0, 0])
    s = np.cross(helper, direction)
    s /= np.linalg.norm(s)
    turned = np.eye(4)
    turned[:3, :3] = np.column_stack([s, np.cross(direction, s), direction])
    return turned


def choose_steps(volume: Volume, quality: float = 1.0) -> int:
    """Return the number of parts of a ray: `quality` for each voxel along the longest axis."""
    return round(quality * max(LEAST_STEPS, *volume.size))
