"""Balls, boxes, columns and gates on a ground, scattered like a child's bricks."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.shadows.maps.scenes._stage import (
    make_ball,
    make_box,
    make_camera_and_sun,
    make_ground,
    make_matte,
    make_pole,
    name_shapes_by_number,
)

COLOURS = np.array(
    [(0.75, 0.2, 0.14), (0.85, 0.55, 0.12), (0.2, 0.42, 0.62), (0.3, 0.5, 0.24), (0.8, 0.76, 0.66)]
)


def objects_on_a_ground(
    view: str = "V1", light: int = 1, size: tuple[int, int] = (512, 512)
) -> dict[str, Any]:
    """Return the dictionary of the scene, in one of its views and suns, for `mitsuba.load_dict`.

    >>> objects_on_a_ground()["floor"]["type"]
    'rectangle'
    """
    random = np.random.default_rng(2008)
    places = [(x, y) for x in range(-4, 5, 2) for y in range(-4, 5, 2)]
    bricks = [
        make_bricks(random, place + random.uniform(-0.45, 0.45, 2), COLOURS[i % len(COLOURS)])
        for i, place in enumerate(np.array(places, float))
    ]

    def place_eye(azimuth: float) -> tuple[float, float, float]:
        return -9 * np.sin(azimuth), -9 * np.cos(azimuth), 5.2

    return (
        make_camera_and_sun(view, light, size, place_eye, down=28, fov=48)
        | {"floor": make_ground(9, (0.62, 0.6, 0.56))}
        | name_shapes_by_number("brick", [thing for things in bricks for thing in things])
    )


def make_bricks(
    random: np.random.Generator, place: FloatArray, colour: FloatArray
) -> list[dict[str, Any]]:
    """Return the shapes of a random object at a place (2,): a ball, box, column or gate."""
    import mitsuba as mi

    x, y = place.tolist()
    kind, large, turn = random.integers(4), random.uniform(0.3, 0.6), random.uniform(0, 90)
    if kind == 0:
        return [make_ball([x, y, large], large, colour)]
    if kind == 1:
        return [make_box([x, y, 0], [2 * large, large, large], colour, turn)]
    if kind == 2:
        top, radius = 4 * large, large / 2
        to_world = mi.ScalarTransform4f().translate([x, y, top]).scale([radius, radius, 1])
        lid = {"type": "disk", "bsdf": make_matte(colour), "to_world": to_world}
        return [make_pole([x, y, 0], top, radius, colour), lid]
    post = [0.4 * large, 0.4 * large, 3 * large]
    posts = [make_box([foot, y, 0], post, colour) for foot in (x - large, x + large)]
    beam = make_box([x, y, 3 * large], [2.6 * large, 0.4 * large, 0.4 * large], colour)
    return [*posts, beam]
