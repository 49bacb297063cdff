"""Defines the scenes of `make_shadow_map_gradients.py`: closed meshes that cast shadows."""

from dataclasses import dataclass

import numpy as np

import brdfkit  # noqa: F401  (chooses LLVM before Mitsuba is loaded)

LIGHTS = {
    "sun": {"type": "directional", "direction": [0.5, 0.3, -1]},
    "lamp": {"type": "point", "position": [-2.5, -1.5, 6]},
}
# Corners of the triangles of a box, two for each side; corners are numbered as in `make_box`
FACES = np.array(
    [
        *[(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)],
        *[(0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)],
        *[(0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)],
    ]
)


@dataclass(frozen=True)
class Solid:
    """A closed mesh; `corners`: its points (n, 3), `triangles`: indices of corners (m, 3)."""

    corners: np.ndarray
    triangles: np.ndarray

    def __add__(self, other):
        beyond = other.triangles + len(self.corners)
        return Solid(
            np.concatenate([self.corners, other.corners]),
            np.concatenate([self.triangles, beyond]),
        )

    def make_mesh(self, name):
        """Return the solid as a `mi.Mesh` with a name."""
        import mitsuba as mi

        mesh = mi.Mesh(name, len(self.corners), len(self.triangles))
        buffers = mi.traverse(mesh)
        buffers["vertex_positions"] = np.ravel(self.corners).astype(np.float32)
        buffers["faces"] = np.ravel(self.triangles).astype(np.uint32)
        buffers.update()
        return mesh


def make_box(centre, half, turn=0.0):
    """Return a cuboid with a `centre` and `half` edges, turned about z by `turn` [rad]."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    c, s = np.cos(turn), np.sin(turn)
    return Solid(signs * half @ [[c, s, 0], [-s, c, 0], [0, 0, 1]] + centre, FACES)


def make_ring(centre, radius, thickness, around=20, about=8):
    """Return a tilted torus; `around`, `about`: numbers of corners along the two circles."""
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(about) / about)
    u, v = u.T.ravel(), v.T.ravel()
    out = radius + thickness * np.cos(v)
    corners = np.column_stack([out * np.cos(u), out * np.sin(u), thickness * np.sin(v)])
    lean = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])

    def find_corner(i, j):
        """Return the index of a corner on the grid of both circles."""
        return (i % around) * about + j % about

    triangles = []
    for i in range(around):
        for j in range(about):
            a, b, c, d = (find_corner(i + k, j + l) for k, l in ((0, 0), (1, 0), (1, 1), (0, 1)))
            triangles += [(a, b, c), (a, c, d)]
    return Solid(corners @ lean.T + centre, np.array(triangles))


def make_fence():
    """Return a fence of seven bars side by side, each 0.06 thick."""
    across = np.array([np.cos(0.3), np.sin(0.3), 0])
    places = [[0, 0, 1.2] + 0.25 * i * across for i in range(-3, 4)]
    bars = [make_box(place, [0.03, 0.7, 0.03], 0.3) for place in places]
    return sum(bars[1:], bars[0])


# Scenes by name: the solid that moves, and another solid or None
SCENES = {
    "box": (make_box([0, 0, 1], [0.6, 0.5, 0.4], 0.5), None),
    "ring": (make_ring(np.array([0, 0, 1.2]), 0.7, 0.22), None),
    "fence": (make_fence(), None),
    "plates": (
        make_box([0, 0, 2.2], [0.5, 0.5, 0.05], 0.4),
        make_box([0.1, 0.3, 1], [0.5, 0.5, 0.05], -0.4),
    ),
}


def load_scene(name, light):
    """Return the `mi.Scene` with a movable shape "thing" above a ground at z = 0."""
    import mitsuba as mi

    thing, other = SCENES[name]
    t = mi.ScalarTransform4f()
    film = {"type": "hdrfilm", "width": 64, "height": 64}
    view = t.look_at([2.5, -5, 3.5], [0.4, 0.2, 0.2], [0, 0, 1])
    found = {
        "type": "scene",
        "light": LIGHTS[light],
        "camera": {"type": "perspective", "fov": 45, "to_world": view, "film": film},
        "ground": {"type": "rectangle", "to_world": t.scale(3)},
        "thing": thing.make_mesh("thing"),
    }
    if other:
        found["other"] = other.make_mesh("other")
    return mi.load_dict(found)
