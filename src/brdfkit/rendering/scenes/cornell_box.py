"""A ball and a tall block in a room with a red and a green wall, under a lamp."""

from brdfkit.rendering.scenes._studio import camera

RED, GREEN, WHITE = (0.57, 0.05, 0.04), (0.1, 0.36, 0.07), (0.72, 0.71, 0.67)
HALF = 2.0  # of the room's width and height; its floor is z = 0, its back wall y = HALF
FRONT = -9.6  # y of the front wall, behind the camera: no material mirrors a black opening


def cornell_box(bsdf, size=(512, 512)):
    """The scene's dictionary; see `brdfkit.rendering.scenes`.

    Both the ball and the block show the material: so it is seen flat and curved, and lit by lamp
    and walls.

    >>> cornell_box({"type": "diffuse"})["lamp"]["type"]
    'rectangle'
    """
    import mitsuba as mi

    at = mi.ScalarTransform4f()
    block = at.translate([-0.8, 0.7, 1.25]).rotate([0, 0, 1], 20).scale([0.6, 0.6, 1.25])
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8},
        "sensor": camera((0, -9.4, HALF), (0, 0, HALF), 29.9, size),
        "lamp": {
            "type": "rectangle",
            "to_world": at.translate([0, -0.5, 2 * HALF - 0.01]).rotate([1, 0, 0], 180).scale(0.9),
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [7.0, 6.4, 5.4]}},
        },
        **_walls(),
        "ball": {"type": "sphere", "center": [0.8, -0.55, 0.85], "radius": 0.85, "bsdf": bsdf},
        "block": {"type": "cube", "to_world": block, "bsdf": bsdf},
    }


def _walls():
    """The dictionaries of the six walls by name."""
    middle, half_depth = (HALF + FRONT) / 2, (HALF - FRONT) / 2
    return {
        "floor": _wall((0, middle, 0), (0, 0, 1), (HALF, half_depth), WHITE),
        "ceiling": _wall((0, middle, 2 * HALF), (0, 0, -1), (HALF, half_depth), WHITE),
        "back": _wall((0, HALF, HALF), (0, -1, 0), (HALF, HALF), WHITE),
        "front": _wall((0, FRONT, HALF), (0, 1, 0), (HALF, HALF), WHITE),
        "left": _wall((-HALF, middle, HALF), (1, 0, 0), (half_depth, HALF), RED),
        "right": _wall((HALF, middle, HALF), (-1, 0, 0), (half_depth, HALF), GREEN),
    }


def _wall(middle, facing, halves, colour):
    """The dictionary of a wall about a `middle`; `halves`: of its width and its height."""
    import mitsuba as mi

    target = [m + f for m, f in zip(middle, facing, strict=True)]
    up = [0, 1, 0] if facing[2] else [0, 0, 1]
    at = mi.ScalarTransform4f()
    reflectance = {"type": "rgb", "value": list(colour)}
    return {
        "type": "rectangle",
        "to_world": at.look_at(list(middle), target, up) @ at.scale([*halves, 1]),
        "bsdf": {"type": "diffuse", "reflectance": reflectance},
    }
