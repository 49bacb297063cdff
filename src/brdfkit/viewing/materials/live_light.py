"""`LiveLight`: an environment map, or a lamp at a point, as the scenes of a view share it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.jit.llvm import use_variant
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scenes._studio import BALL
from brdfkit.viewing.recent import Recent

LIGHTS = 4  # kept at most
LAMP = "lamp"  # the name of the light that is a lamp at a point
DEPTH = 6  # largest number of segments of a path
PICTURES_BEFORE = 3  # at rest, before a map is filtered for moves, which takes two seconds


class LiveLight:
    """A light, with the integrators that show materials in it.

    `name` is that of an environment map, its file, or `LAMP`. Attributes: `emitter`, Mitsuba's;
    `noise_free`, the integrator for pictures while something moves, which keeps the filtered map;
    `traced`, that for pictures at rest.
    """

    def __init__(self, name: str, described: dict[str, Any]) -> None:
        import mitsuba as mi

        use_variant()
        self.name, self.is_lamp = name, name == LAMP
        self.emitter = load_by_mitsuba(mi.load_dict, described, name)
        self.parameters = mi.traverse(self.emitter)
        self.shown: Any = None  # the turn, or the lamp's place, as it is
        direct = {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}
        filtered = {"type": "filtered_environment"}
        self.noise_free = mi.load_dict(direct if self.is_lamp else filtered)
        self.traced = mi.load_dict({"type": "path", "max_depth": DEPTH})
        self.pictures = 0  # at rest, so far
        if not self.is_lamp:
            self.noise_free.light.only_turns = True  # no other parameter is changed here

    @property
    def is_filtered(self) -> bool:
        """Whether a picture without noise needs no filtering that is still to be done."""
        return self.is_lamp or self.noise_free.light.is_filtered

    def count_picture(self) -> None:
        """Count a picture at rest; after a few, begin to filter the map in a thread of its own."""
        self.pictures += 1
        if not self.is_lamp and self.pictures == PICTURES_BEFORE:
            self.noise_free.light.begin(self.emitter)

    def show(self, turn: float, lamp: FloatArray) -> None:
        """Turn the map about the vertical axis [degrees], or move the lamp to a place (3,).

        The lamp becomes brighter with its distance, so that the ball's illuminance stays 1.
        """
        import drjit as dr
        import mitsuba as mi

        new: Any = tuple(map(float, lamp)) if self.is_lamp else float(turn)
        if new == self.shown:
            return
        if self.is_lamp:
            strength = float(np.sum(np.square(np.subtract(lamp, BALL))))
            place = mi.Point3f(*new)
            colour = mi.Color3f(strength)
            dr.make_opaque(place, colour)
            self.parameters["position"], self.parameters["intensity.value"] = place, colour
        else:
            at = mi.ScalarTransform4f()
            turned = at.rotate([0, 0, 1], new) @ at.rotate([1, 0, 0], 90)
            matrix = np.array(turned.matrix, np.float32)
            self.parameters["to_world"] = mi.Transform4f(matrix)
        self.parameters.update()
        self.shown = new


class LiveLights:
    """The lights of a view by name, each loaded when it is first shown.

    `environments` are maps (height, width, 3) by name, besides those that brdfkit knows.
    """

    def __init__(self, environments: Mapping[str, AnyArray] = MappingProxyType({})) -> None:
        self.environments = environments
        self.loaded: Recent[str, LiveLight] = Recent(LIGHTS)

    def get(self, name: str) -> LiveLight:
        """Return a light; raise `BrdfkitError` if no map has this name."""
        return self.loaded.get(name, lambda: LiveLight(name, self._describe(name)))

    def _describe(self, name: str) -> dict[str, MitsubaObject]:
        """Return Mitsuba's dictionary of a light."""
        if name == LAMP:
            white = {"type": "rgb", "value": [1.0, 1.0, 1.0]}
            return {"type": "point", "position": list(BALL), "intensity": white}
        return describe_environment(self.environments.get(name, name))
