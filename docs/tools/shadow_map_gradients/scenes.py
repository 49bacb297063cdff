"""What casts the shadows of `make_shadow_map_gradients.py`: closed meshes that share corners."""

from dataclasses import dataclass

import numpy as np

import brdfkit  # noqa: F401  (chooses LLVM before Mitsuba is loaded)

LIGHTS = {
    "sun": {"type": "directional", "direction": [0.5, 0.3, -1]},
    "lamp": {"type": "point", "position": [-2.5, -1.5, 6]},
}
# Of a box with the corners of `box`, two triangles a side
FACES = np.array(
    [
        *[(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)],
        *[(0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)],
        *[(0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)],
    ]
)


@dataclass(frozen=True)
class Solid:
    """A closed mesh: its corners (n, 3) and triangles (m, 3)."""

    corners: np.ndarray
    triangles: np.ndarray

    def __add__(self, other):
        beyond = other.triangles + len(self.corners)
        return Solid(
            np.concatenate([self.corners, other.corners]),
            np.concatenate([self.triangles, beyond]),
        )

    def shape(self, name):
        """The `mi.Mesh`."""
        import mitsuba as mi

        mesh = mi.Mesh(name, len(self.corners), len(self.triangles))
        buffers = mi.traverse(mesh)
        buffers["vertex_positions"] = np.ravel(self.corners).astype(np.float32)
        buffers["faces"] = np.ravel(self.triangles).astype(np.uint32)
        buffers.update()
        return mesh


def box(centre, half, turn=0.0):
    """A cuboid, turned about z [rad]."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    c, s = np.cos(turn), np.sin(turn)
    return Solid(signs * half @ [[c, s, 0], [-s, c, 0], [0, 0, 1]] + centre, FACES)


def ring(centre, radius, thickness, around=20, about=8):
    """A torus that leans."""
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(about) / about)
    u, v = u.T.ravel(), v.T.ravel()
    out = radius + thickness * np.cos(v)
    corners = np.column_stack([out * np.cos(u), out * np.sin(u), thickness * np.sin(v)])
    lean = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])

    def at(i, j):
        return (i % around) * about + j % about

    triangles = []
    for i in range(around):
        for j in range(about):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [(a, b, c), (a, c, d)]
    return Solid(corners @ lean.T + centre, np.array(triangles))


def fence():
    """Seven bars, each 0.06 thick, side by side."""
    across = np.array([np.cos(0.3), np.sin(0.3), 0])
    places = [[0, 0, 1.2] + 0.25 * i * across for i in range(-3, 4)]
    bars = [box(place, [0.03, 0.7, 0.03], 0.3) for place in places]
    return sum(bars[1:], bars[0])


# Name → the solid that moves, and what else stands there
SCENES = {
    "box": (box([0, 0, 1], [0.6, 0.5, 0.4], 0.5), None),
    "ring": (ring(np.array([0, 0, 1.2]), 0.7, 0.22), None),
    "fence": (fence(), None),
    "plates": (
        box([0, 0, 2.2], [0.5, 0.5, 0.05], 0.4),
        box([0.1, 0.3, 1], [0.5, 0.5, 0.05], -0.4),
    ),
}


def load(name, light):
    """The `mi.Scene`, with the shape "thing", which moves, above a ground in z = 0."""
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
        "thing": thing.shape("thing"),
    }
    if other:
        found["other"] = other.shape("other")
    return mi.load_dict(found)
