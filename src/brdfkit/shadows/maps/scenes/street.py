"""Two streets of a small town, seen from their crossing: a view much deeper than wide.

The eye is 1.7 m above the ground. The nearest visible surface is 3 m away, and the farthest 200 m,
so that the ratio of far to near is about 70.
"""

from typing import Any

import numpy as np

from brdfkit.shadows.maps.scenes._stage import (
    make_ball,
    make_box,
    make_camera_and_sun,
    make_ground,
    make_pole,
    name_shapes_by_number,
)

LENGTH = 200.0  # length of a street, from the crossing to its end [m]
WIDTH = 16.0  # width of a street, from house to house [m]
HOUSE = 14.0  # side of the square plot of a house [m]
WALLS = [(0.74, 0.66, 0.54), (0.7, 0.46, 0.34), (0.78, 0.74, 0.68), (0.6, 0.5, 0.42)]
DARK, GREEN = (0.12, 0.12, 0.13), (0.2, 0.34, 0.13)


def street(view: str = "V1", light: int = 1, size: tuple[int, int] = (512, 512)) -> dict[str, Any]:
    """Return the dictionary of the scene, in one of its views and suns, for `mitsuba.load_dict`.

    >>> street()["ground"]["type"]
    'rectangle'
    """
    random = np.random.default_rng(16)
    sides = [(along, way, side) for along in (0, 1) for way in (-1, 1) for side in (-1, 1)]
    things = [thing for side in sides for thing in make_street_side(random, *side)]
    return (
        make_camera_and_sun(view, light, size, lambda azimuth: (0.5, -0.5, 1.7), down=0.5, fov=60)
        | {"ground": make_ground(LENGTH + 20, (0.32, 0.32, 0.33))}
        | name_shapes_by_number("thing", things)
    )


def make_street_side(
    random: np.random.Generator, along: int, way: int, side: int
) -> list[dict[str, Any]]:
    """Return the houses, trees, lamps and cars on one side of a street that begins at the crossing.

    along : axis along which the street runs, 0 (x) or 1 (y).
    way : direction from the crossing along the axis, -1 or 1.
    side : side of the street, -1 or 1.
    """

    def to_position(distance: float, aside: float, height: float = 0.0) -> list[float]:
        across = side * aside
        x, y = (way * distance, across) if along == 0 else (across, way * distance)
        return [x, y, height]

    def to_box_size(length: float, width: float, height: float) -> list[float]:
        return [length, width, height] if along == 0 else [width, length, height]

    kerb = (LENGTH - WIDTH / 2, WIDTH / 2 - 6)
    pavement = to_position((LENGTH + WIDTH / 2) / 2, 7)
    things = [make_box(pavement, to_box_size(*kerb, 0.15), (0.55, 0.54, 0.52))]
    for i, distance in enumerate(np.arange(WIDTH / 2 + HOUSE / 2, LENGTH, HOUSE)):
        tall, wall = random.uniform(6, 15), WALLS[random.integers(len(WALLS))]
        middle, roof = WIDTH / 2 + HOUSE / 2, to_box_size(HOUSE, HOUSE + 0.8, 0.4)
        things += [
            make_box(to_position(distance, middle), to_box_size(HOUSE - 0.6, HOUSE, tall), wall),
            make_box(to_position(distance, middle, tall), roof, (0.35, 0.2, 0.16)),
            make_pole(to_position(distance + 4, 5.5), 5.5, 0.07, DARK),
            make_box(to_position(distance + 4, 4.9, 5.5), to_box_size(0.2, 1.4, 0.12), DARK),
        ]
        if side > 0:
            things.append(
                make_box(to_position(distance, 0), to_box_size(3, 0.18, 0.02), (0.8, 0.8, 0.78))
            )
        if random.random() < 0.75:
            tree = random.uniform(1.3, 1.9)
            things += [
                make_pole(to_position(distance - 3, 5.5), 3, 0.15, (0.25, 0.18, 0.12)),
                make_ball(to_position(distance - 3, 5.5, 3 + 0.7 * tree), tree, GREEN),
            ]
        if i % 2 == 0:
            paint = random.uniform(0.1, 0.7, 3)
            things += [
                make_box(to_position(distance, 3.2, 0.25), to_box_size(4.2, 1.7, 0.6), paint),
                make_box(to_position(distance, 3.2, 0.85), to_box_size(2.2, 1.5, 0.55), DARK),
            ]
    return things
