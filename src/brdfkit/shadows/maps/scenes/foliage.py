"""Trees of many small leaves over a meadow, whose shadows consist almost only of borders."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.shadows.maps.scenes._stage import (
    make_camera_and_sun,
    make_ground,
    make_matte,
    make_pole,
    name_shapes_by_number,
)

LEAVES = 3000  # number of leaves of each tree
BLADES = 6000  # number of blades of grass in the meadow
TREES = [(0, 0), (3.6, 1.2), (-3.2, 2.4), (1.2, -3.8), (-2.8, -2.6), (4.4, -3.2), (-0.6, 4.6)]


def foliage(view: str = "V1", light: int = 1, size: tuple[int, int] = (512, 512)) -> dict[str, Any]:
    """Return the dictionary of the scene, in one of its views and suns, for `mitsuba.load_dict`.

    >>> foliage()["stem_0"]["type"]
    'cylinder'
    """
    random = np.random.default_rng(24)
    leaves: list[FloatArray] = []
    stems: list[dict[str, Any]] = []
    for x, y in TREES:
        tall = random.uniform(1.4, 2.2)
        leaves.append(make_crown(random, [x, y, tall + 0.9], [1.35, 1.35, 1.1]))
        stems.append(make_pole([float(x), float(y), 0], tall + 0.8, 0.11, (0.3, 0.2, 0.13)))
    blades = make_grass(random)

    def place_eye(azimuth: float) -> tuple[float, float, float]:
        return -10.5 * np.sin(azimuth), -10.5 * np.cos(azimuth), 4.4

    return (
        make_camera_and_sun(view, light, size, place_eye, down=17, fov=46)
        | {"meadow": make_ground(10, (0.4, 0.42, 0.22))}
        | {"leaves": make_mesh(np.concatenate(leaves), (0.24, 0.4, 0.1))}
        | {"grass": make_mesh(blades, (0.36, 0.44, 0.14))}
        | name_shapes_by_number("stem", stems)
    )


def make_crown(random: np.random.Generator, centre: list[float], radii: list[float]) -> FloatArray:
    """Return the leaves of a tree's crown as triangles (2 n, 3, 3), two for each of n leaves.

    The leaves are at random near the surface of an ellipsoid with this centre and these radii.
    """
    outwards = random.normal(size=(LEAVES, 3))
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    middles = np.array(centre) + radii * outwards * random.uniform(0.55, 1, (LEAVES, 1)) ** 0.5
    along = 0.06 * (outwards + random.normal(size=(LEAVES, 3)))
    across = 0.4 * np.cross(along, random.normal(size=(LEAVES, 3)))
    foot, tip = middles - along, middles + along
    halves = [(foot, middles - across, tip), (foot, tip, middles + across)]
    return np.concatenate([np.stack(half, axis=1) for half in halves])


def make_grass(random: np.random.Generator) -> FloatArray:
    """Return random blades of grass, a triangle each, (n, 3, 3)."""
    feet = np.column_stack([random.uniform(-8, 8, (BLADES, 2)), np.zeros(BLADES)])
    aside = np.column_stack([0.03 * random.normal(size=(BLADES, 2)), np.zeros(BLADES)])
    bend, height = 0.07 * random.normal(size=(BLADES, 2)), random.uniform(0.1, 0.3, BLADES)
    tips = feet + np.column_stack([bend, height])
    return np.stack([feet - aside, feet + aside, tips], axis=1)


def make_mesh(corners: FloatArray, colour: tuple[float, float, float]) -> MitsubaObject:
    """Return a matte `mitsuba.Mesh` of triangles (n, 3, 3), given by their corners."""
    import mitsuba as mi

    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(make_matte(colour), parallel=False)
    mesh = mi.Mesh("triangles", 3 * len(corners), len(corners), properties)
    buffers = mi.traverse(mesh)
    buffers["vertex_positions"] = np.ravel(corners).astype(np.float32)
    buffers["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
    buffers.update()
    return mesh
