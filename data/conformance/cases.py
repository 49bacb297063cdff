"""The cases of the conformance set: volumes, what their values mean, and where they are seen from.

Each lies in the cube from -1 to 1. To add one, write a function like those below; `make.py` then
computes its picture.
"""

import numpy as np

AHEAD = [0, 0, -1]  # along the axis z
OBLIQUE = [-0.6, -0.5, -1.0]


def homogeneous():
    """One value everywhere: lengths of rays through the box."""
    return case(np.ones((8, 8, 8)), [0, 1], [[1, 0.6, 0.2, 1]] * 2, 1.0, OBLIQUE)


def ramp():
    """Values that rise along the ray, steeper from left to right; a linear function."""
    points = [[0.1, 0.3, 1, 0], [1, 0.4, 0.1, 1]]
    return case(slopes(16), [0, 1], points, 2.0, AHEAD)


def step():
    """The ramp in coarse voxels; a function with a step: where a program classifies."""
    points = [[1, 1, 1, 0], [1, 1, 1, 0], [1, 0.3, 0.1, 1], [0.1, 0.3, 1, 1]]
    return case(slopes(8), [0, 0.4, 0.4, 1], points, 3.0, AHEAD)


def ball():
    """A smooth ball, and colours in four segments, seen obliquely."""
    return case(hill((24, 24, 24)), *SHELLS, 6.0, OBLIQUE, half=0.9)


def layer():
    """A narrow peak of the function: a thin layer in the ball, which long steps miss."""
    values, glow = [0, 0.39, 0.4, 0.41, 1], [1, 0.8, 0.3]
    points = [[*glow, 0], [*glow, 0], [*glow, 1], [*glow, 0], [*glow, 0]]
    return case(hill((24, 24, 24)), values, points, 90.0, AHEAD)


def anisotropic():
    """The ball in voxels that are four times as long along z."""
    return case(hill((6, 24, 24)), *SHELLS, 6.0, OBLIQUE, half=0.9)


def opacity():
    """The ball with opacities of layers that are 0.1 thick, as VTK and Slicer state them."""
    values, points = (
        [0, 0.1, 0.6, 1],
        [[0.2, 0.4, 1, 0], [0.2, 0.4, 1, 0], [1, 0.9, 0.4, 0.5], [1, 0.2, 0.1, 0.95]],
    )
    return case(
        hill((24, 24, 24)), values, points, None, OBLIQUE, half=0.9, opacity_unit_distance=0.1
    )


def gradients():
    """A soft edge along x, and a function of values × gradient magnitudes."""
    x = centres(16)
    edge = np.broadcast_to(0.5 + 0.5 * np.tanh(5 * x), (16, 16, 16))
    points = np.array([[0.2, 0.4, 1, 1], [1, 0.4, 0.1, 1]])
    over = [points * [1, 1, 1, factor] for factor in (0, 1)]
    return case(edge, [0, 1], over, 1.5, AHEAD, gradients=[0, 2.5])


def labels():
    """Four tissues, which are not interpolated: the nearest voxel counts."""
    voxels = np.random.default_rng(8).integers(0, 4, (6, 6, 6)).astype(np.uint8)
    points = [[0, 0, 0, 0], [1, 0.3, 0.2, 0.3], [0.3, 1, 0.4, 0.6], [0.3, 0.5, 1, 1]]
    return case(voxels, [0, 1, 2, 3], points, 2.0, OBLIQUE, labels=True)


def maximum():
    """Smooth noise: the colour of the largest value along each ray."""
    noise = np.random.default_rng(3).random((6, 6, 6))
    points = [[0, 0, 0.2, 1], [0.6, 0.1, 0.4, 1], [1, 0.6, 0.1, 1], [1, 1, 0.8, 1]]
    return case(noise, [0.5, 0.7, 0.85, 1], points, 1.0, OBLIQUE, renderer="maximum_intensity")


def saddle():
    """The level 0 of -z - xy / 2, a saddle that trilinear values have exactly; lit by the eye."""
    z, y, x = np.meshgrid(*[centres(16)] * 3, indexing="ij")
    settings = {"renderer": "isosurface", "level": 0.0, "albedo": [0.9, 0.6, 0.3], "half": 0.5}
    return case(-z - x * y / 2, [-1, 1], [[1, 1, 1, 0], [1, 1, 1, 1]], 1.0, OBLIQUE, **settings)


SHELLS = (
    [0, 0.1, 0.3, 0.6, 1],
    [
        [0.2, 0.4, 1, 0],
        [0.2, 0.4, 1, 0],
        [0.2, 0.7, 0.9, 0.1],
        [1, 0.8, 0.3, 0.3],
        [1, 0.2, 0.1, 1],
    ],
)
MAKERS = (homogeneous, ramp, step, ball, layer, anisotropic, opacity, gradients, labels, maximum)
CASES = {f.__name__: f for f in (*MAKERS, saddle)}


def case(voxels, values, rgba, extinction, towards, **other):
    """The voxels (nz, ny, nx), and all else as it stands in `cases.json`."""
    transfer = {"values": values, "rgba": np.array(rgba).tolist(), "extinction": extinction}
    for name in ("gradients", "opacity_unit_distance"):
        if name in other:
            transfer[name] = other.pop(name)
    if voxels.dtype.kind == "f":
        voxels = voxels.astype(np.float32)
    if "half" not in other:
        other["half"] = 1.2 if towards == AHEAD else 1.7
    told = {"renderer": "emission_absorption", "labels": False, "towards": towards}
    return voxels, told | other | {"transfer": transfer}


def centres(n):
    """The middles of n voxels from -1 to 1."""
    return (2 * np.arange(n) + 1) / n - 1


def slopes(n):
    x, z = centres(n), centres(n)[:, None, None]
    return np.broadcast_to((z + 1) / 2 * (0.65 + 0.35 * x), (n, n, n))


def hill(shape):
    """exp(-4 r²), 1 in the middle and 0.02 at the nearest faces."""
    z, y, x = np.meshgrid(*map(centres, shape), indexing="ij")
    return np.exp(-4 * (x * x + y * y + z * z))
