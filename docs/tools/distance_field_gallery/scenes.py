"""Defines six scenes of distance functions with measured materials, for `distance_fields.md`.

The page shows each function next to its picture.
"""

from math import pi

from distance_field_gallery.gyroid import gyroid
from distance_field_gallery.stage import bulb, camera, cove, panel, scene

from brdfkit.distance_fields import (
    box,
    capped_cone,
    capped_cylinder,
    capsule,
    mandelbulb,
    plane,
    rounded_box,
    sphere,
    torus,
    union,
)


def still_life():
    """Still life: a cloth of gold brocade, a satin vase, and apples in a bowl of brushed
    aluminium, by a square window. A vase is a ball blended into a cone; a bowl, the shell of a ball
    cut open; an apple, a ball less a smooth cone.
    """
    up = plane((0, 0, -1))  # what is above z = 0
    table = rounded_box((6.4, 3.6, 0.3), 0.06).at(0, 0.1, -0.15).made_of("cloth")
    neck = capped_cone((0, 0, 1.2), (0, 0, 2.0), 0.4, 0.2) | torus(0.24, 0.07).at(0, 0, 2.0).k(0.1)
    vase = (sphere(0.8).at(0, 0, 0.75) | neck.k(0.5)) - plane().at(0, 0, 0.02)
    hollow = capped_cylinder((0, 0, 1.5), (0, 0, 3), 0.17)
    bowl = sphere(0.8).at(0, 0, 0.78).shell(0.07) - up.at(0, 0, 0.66).k(0.06)
    flesh = sphere(0.34) - capped_cone((0, 0, 0.1), (0, 0, 0.5), 0.01, 0.3).k(0.2)
    stalk = capsule((0, 0, 0.1), (0.05, 0, 0.38), 0.022)

    def apple(x, y, z, lean, about):
        whole = flesh.made_of("fruit") | stalk.made_of("stalk")
        return whole.rotate(lean, about).at(x, y, z)

    field = (
        table
        | plane((0, -1, 0)).at(0, 4, 0).made_of("wall")
        | (vase - hollow.k(0.08)).at(-1.35, 0.5, 0).made_of("vase")
        | bowl.at(1.15, 0.1, 0).made_of("bowl")
        | apple(0.87, 0, 0.6, 0.5, (1, 0, 0))
        | apple(1.47, 0.2, 0.62, -0.4, (0, 1, 0))
        | apple(-0.2, -0.85, 0.33, 0.3, (1, 0, 0))
    )
    materials = {
        "cloth": "gold_brocade",
        "wall": [0.55, 0.5, 0.42],
        "vase": "satin_plastic",
        "bowl": "brushed_aluminium",
        "fruit": "red_plastic",
        "stalk": "dusty_gold",
    }
    lights = {
        "window": panel([-5, -2.5, 4.0], [0, 0, 0.6], 1.3, [29, 26, 22]),
        "fill": bulb([6, -12, 9], 3, [2.0, 2.4, 3.2]),
    }
    return scene(
        field, materials, lights, camera([0.3, -8.2, 2.6], [0, 0, 0.8], 35), shadow="split"
    )


def chess():
    """Chess: pieces as if turned on a lathe, of plaster and of blasted gold, and tiles of car
    paint. `repeat` makes endless tiles of one, of which a box cuts out the board.
    """

    def turned(foot, waist, height):
        """What all pieces have: a foot, a stem, a collar."""
        stem = capped_cone((0, 0, 0.2), (0, 0, height), foot * 0.62, waist)
        base = capped_cylinder((0, 0, 0), (0, 0, 0.12), foot - 0.04).dilate(0.04)
        return base | stem.k(0.25) | torus(waist * 1.15, 0.055).at(0, 0, height).k(0.05)

    pawn = turned(0.36, 0.13, 0.62) | sphere(0.22).at(0, 0, 0.8).k(0.05)
    mitre = sphere(0.2).at(0, 0, 1.08) | capped_cone((0, 0, 1.1), (0, 0, 1.4), 0.17, 0.04).k(0.2)
    slot = box((0.05, 1, 0.4)).rotate(0.5, (0, 1, 0)).at(0.14, 0, 1.28)
    bishop = turned(0.4, 0.14, 0.9) | (mitre | sphere(0.05).at(0, 0, 1.44).k(0.03)) - slot
    gaps = box((0.12, 1, 0.3)).at(0, 0, 1.22) | box((1, 0.12, 0.3)).at(0, 0, 1.22)
    tower = capped_cylinder((0, 0, 0.72), (0, 0, 1.16), 0.26).dilate(0.02)
    rook = turned(0.42, 0.2, 0.72) | tower - capped_cylinder((0, 0, 1), (0, 0, 2), 0.17) - gaps
    arms = rounded_box((0.26, 0.07, 0.09), 0.02).at(0, 0, 0.04)
    cross = rounded_box((0.09, 0.07, 0.36), 0.02) | arms
    crown = capped_cone((0, 0, 1.1), (0, 0, 1.45), 0.15, 0.25) | sphere(0.2).at(0, 0, 1.45).k(0.1)
    king = turned(0.45, 0.16, 1.1) | crown.k(0.05) | cross.at(0, 0, 1.78)

    tiles = rounded_box((0.985, 0.985, 0.2), 0.015).at(0.5, 0.5, -0.1).repeat((2, 2, 0))
    dark = tiles | tiles.at(1, 1, 0)
    board = box((8, 8, 1))
    white = king.at(-0.5, -1.5, 0) | pawn.at(-2.5, -1.5, 0) | rook.at(-2.5, 0.5, 0)
    black = bishop.at(1.5, -0.5, 0) | pawn.at(0.5, -2.5, 0) | rook.at(0.5, 1.5, 0)
    field = (
        white.made_of("white")
        | black.made_of("black")
        | (dark & board).made_of("dark")
        | (dark.at(1, 0, 0) & board).made_of("light")
        | rounded_box((8.8, 8.8, 0.3), 0.08).at(0, 0, -0.2).made_of("rim")
        | cove(12).at(0, 0, -0.35).made_of("table")
    )
    materials = {
        "white": "plaster",
        "black": "blasted_gold",
        "dark": "car_paint",
        "light": "plaster",
        "rim": "red_plastic",
        "table": [0.3, 0.27, 0.25],
    }
    lights = {
        "lamp": bulb([-6, 2.2, 4.5], 0.7, [150, 132, 108]),
        "fill": bulb([-5, -11, 8], 3, [2.8, 3.1, 3.6]),
    }
    return scene(
        field, materials, lights, camera([1.6, -7.6, 3.3], [-0.35, -0.6, 0.4], 39), shadow="split"
    )


def rings():
    """A chain: rings of blasted gold and satin plastic. Single marches leak where rings hide each
    other's light; `shadow="split"` mends that.
    """
    ring = torus(1, 0.23)
    to_left, to_right = ring.rotate(pi / 4, (1, 0, 0)), ring.rotate(-pi / 4, (1, 0, 0))
    field = (
        union([to_left.at(1.4 * i, 0, 0.94) for i in (-3, -1, 1, 3)]).made_of("gold")
        | union([to_right.at(1.4 * i, 0, 0.94) for i in (-2, 0, 2)]).made_of("plastic")
        | cove(6).made_of("ground")
    )
    materials = {"gold": "blasted_gold", "plastic": "satin_plastic", "ground": [0.5, 0.45, 0.42]}
    lights = {
        "lamp": bulb([-4, -3, 6], 1.3, [36, 33, 28]),
        "rim": bulb([8, -1, 4], 0.8, [16, 21, 28]),
        "fill": bulb([3, -12, 8], 4, [0.7, 0.8, 1.0]),
    }
    return scene(
        field, materials, lights, camera([-3.6, -7, 3.0], [-0.3, 0, 0.75], 40), shadow="split"
    )


def colonnade():
    """Colonnade: thirteen fluted columns, of which a ray meets only the one of its cell, and of
    its sixteen flutes two, and a low sun. The shadows are as sharp as the sun is small, and soften
    with their length.
    """
    flute = capped_cylinder((0.5, 0, 0.35), (0.5, 0, 3.95), 0.07)
    shaft = capped_cone((0, 0, 0), (0, 0, 4.2), 0.5, 0.42) - flute.circular_array(16).k(0.03)
    base = torus(0.48, 0.12).at(0, 0, 0.14) | rounded_box((1.3, 1.3, 0.2), 0.03).at(0, 0, -0.08)
    echinus = capped_cone((0, 0, 4.1), (0, 0, 4.35), 0.42, 0.6).dilate(0.03)
    column = shaft | base | echinus | rounded_box((1.4, 1.4, 0.22), 0.03).at(0, 0, 4.5)
    row = column.repeat((2.6, 0, 0), 6)
    frieze = rounded_box((40, 1.8, 0.25), 0.05).at(0, -0.1, 5.5)
    beam = rounded_box((40, 1.3, 0.8), 0.04).at(0, 0, 5.0) | frieze
    wall = plane((0, -1, 0)).at(0, 2.2, 0)
    steps = union([box((40, 6 + i, 0.3)).at(0, 1.6, -0.33 - 0.3 * i) for i in range(3)])
    field = (row | beam | wall | steps | plane().at(0, 0, -1.1)).made_of("stone")
    lights = {
        "sun": bulb([-70, -44, 27], 1.6, [2600, 2100, 1450]),
        "sky": bulb([30, -40, 12], 15, [1.0, 1.5, 2.5]),
        "ground": bulb([2, -16, 1.5], 1.5, [5, 4.4, 3.6]),
    }
    return scene(
        field, {"stone": "plaster"}, lights, camera([-6.6, -8.5, 1.0], [0.4, 0.6, 2.15], 46)
    )


def lantern():
    """Lantern: a node of one's own. A gyroid is no distance, but its slope is at most √3; a node
    that says so is as good as any other.
    """
    lace = (gyroid(0.35).scale(0.17) & sphere(1.3).shell(0.12)) - plane((0, 0, -1)).at(0, 0, 1.1)
    field = (
        lace.at(0, 0, 1.27).made_of("lace")
        | sphere(0.55).at(0, 0, 1.25).made_of("core")
        | cove(6).made_of("ground")
    )
    materials = {"lace": "red_plastic", "core": "blasted_gold", "ground": [0.5, 0.45, 0.42]}
    lights = {
        "lamp": bulb([-3.5, -2.5, 5.5], 0.5, [170, 152, 130]),
        "rim": bulb([6, -1, 3], 0.5, [24, 33, 45]),
        "fill": bulb([3, -12, 8], 4, [0.6, 0.7, 0.9]),
    }
    return scene(
        field, materials, lights, camera([0, -7.5, 3.0], [0.25, 0, 1.0], 36), shadow="split"
    )


def fractal():
    """Fractal: a Mandelbulb of dusty gold. Cones as wide as a pixel find details of any size."""
    field = mandelbulb(8, 4).rotate(0.5, (1, 0, 0)).rotate(0.4).at(0, 0, 1.2).made_of("bulb")
    field = field | cove(6).made_of("ground")
    materials = {"bulb": "dusty_gold", "ground": "satin_plastic"}
    lights = {
        "lamp": bulb([-3.5, -2.5, 4.5], 0.6, [90, 82, 70]),
        "rim": bulb([5, -1, 3], 0.6, [36, 48, 64]),
        "fill": bulb([3, -12, 8], 4, [0.7, 0.8, 1.0]),
    }
    return scene(field, materials, lights, camera([0, -7.2, 2.4], [0.0, 0, 1.1], 34))


SCENES = still_life, chess, rings, colonnade, fractal, lantern
