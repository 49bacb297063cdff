"""A ball and a tall block in a room with a red and a green wall, under a lamp."""

from typing import Any

from brdfkit.core.array_types import MitsubaObject
from brdfkit.rendering.scenes._studio import make_camera

RED, GREEN, WHITE = (0.57, 0.05, 0.04), (0.1, 0.36, 0.07), (0.72, 0.71, 0.67)
HALF = 2.0  # half of the room's width and height [m]; the floor is z = 0, the back wall y = HALF
FRONT = -9.6  # y of the front wall [m], behind the camera: a mirror shows no black opening


def cornell_box(
    bsdf: dict[str, Any] | MitsubaObject, size: tuple[int, int] = (512, 512)
) -> dict[str, Any]:
    """Return the dictionary of a scene that shows the material `bsdf` in a Cornell box.

    The ball and the block have the material, so the picture shows it curved and flat, lit by the
    lamp and by the walls.

    >>> cornell_box({"type": "diffuse"})["lamp"]["type"]
    'rectangle'
    """
    import mitsuba as mi

    at = mi.ScalarTransform4f()
    block = at.translate([-0.8, 0.7, 1.25]).rotate([0, 0, 1], 20).scale([0.6, 0.6, 1.25])
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8},
        "sensor": make_camera((0, -9.4, HALF), (0, 0, HALF), 29.9, size),
        "lamp": {
            "type": "rectangle",
            "to_world": at.translate([0, -0.5, 2 * HALF - 0.01]).rotate([1, 0, 0], 180).scale(0.9),
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [7.0, 6.4, 5.4]}},
        },
        **_make_walls(),
        "ball": {"type": "sphere", "center": [0.8, -0.55, 0.85], "radius": 0.85, "bsdf": bsdf},
        "block": {"type": "cube", "to_world": block, "bsdf": bsdf},
    }


def _make_walls() -> dict[str, Any]:
    """Return the dictionaries of the six walls of the room, by name."""
    middle, half_depth = (HALF + FRONT) / 2, (HALF - FRONT) / 2
    return {
        "floor": _make_wall((0, middle, 0), (0, 0, 1), (HALF, half_depth), WHITE),
        "ceiling": _make_wall((0, middle, 2 * HALF), (0, 0, -1), (HALF, half_depth), WHITE),
        "back": _make_wall((0, HALF, HALF), (0, -1, 0), (HALF, HALF), WHITE),
        "front": _make_wall((0, FRONT, HALF), (0, 1, 0), (HALF, HALF), WHITE),
        "left": _make_wall((-HALF, middle, HALF), (1, 0, 0), (half_depth, HALF), RED),
        "right": _make_wall((HALF, middle, HALF), (-1, 0, 0), (half_depth, HALF), GREEN),
    }


def _make_wall(
    middle: tuple[float, float, float],
    normal: tuple[int, int, int],
    halves: tuple[float, float],
    colour: tuple[float, float, float],
) -> dict[str, Any]:
    """Return the dictionary of a wall; `halves` are half its width and half its height [m]."""
    import mitsuba as mi

    target = [m + f for m, f in zip(middle, normal, strict=True)]
    up = [0, 1, 0] if normal[2] else [0, 0, 1]
    at = mi.ScalarTransform4f()
    reflectance = {"type": "rgb", "value": list(colour)}
    return {
        "type": "rectangle",
        "to_world": at.look_at(list(middle), target, up) @ at.scale([*halves, 1]),
        "bsdf": {"type": "diffuse", "reflectance": reflectance},
    }
