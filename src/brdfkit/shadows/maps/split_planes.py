"""Planes across the view that divide what a camera sees into slices, each with a shadow map.

Between the depths n and f there are m slices. Plane i, from 0 to m, is at the depth

    C_log = n (f/n)^(i/m),   C_uni = n + i (f - n)/m   or   C_mean = (C_log + C_uni)/2

With logarithmic planes, texels are about equally large in the picture at all depths, but most
slices are near the eye. Uniform planes spend most slices far away; the mean is a compromise [Zhang
et al. 2006], [Ergun 2008, 2.2.3.4].
"""

from collections.abc import Callable

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitInt, JitVector
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import transform
from brdfkit.mitsuba_bridge.properties.declarations import declare_choice, declare_int

SPACINGS = ("logarithmic", "mean", "uniform")
SETTINGS = {
    "parts": declare_int(4, (1, 8), "parts along the view"),
    "spacing": declare_choice(SPACINGS, "distances of the planes between parts"),
}


def compute_split_planes(near: float, far: float, parts: int, spacing: str) -> FloatArray:
    """Return the depths of the planes that divide the view into `parts` slices, (parts + 1,).

    near, far : depths of the first and the last plane.
    spacing : how the planes are spaced, a word in `SPACINGS`.

    >>> compute_split_planes(1, 100, 2, "logarithmic")
    array([  1.,  10., 100.])
    """
    uniform = np.linspace(near, far, parts + 1)
    logarithmic = np.geomspace(near, far, parts + 1)
    mean = (uniform + logarithmic) / 2
    return {"uniform": uniform, "logarithmic": logarithmic, "mean": mean}[spacing]


def make_slice_finder(camera: Camera, planes: FloatArray) -> Callable[[JitVector], JitInt]:
    """Return a function that finds the index of the slice of the view in which a point lies.

    Points before or behind all slices belong to the first or last slice.

    planes : depths of the planes that bound the slices, in ascending order.
    """
    import mitsuba as mi

    view = mi.Matrix4f(camera.view)
    inner = [dr.opaque(mi.Float, float(plane)) for plane in planes[1:-1]]
    dr.make_opaque(view)

    def find_slice(p: JitVector) -> JitInt:
        depth = -transform(view, *p)[2]
        return sum((dr.select(depth > plane, mi.UInt32(1), 0) for plane in inner), mi.UInt32(0))

    return find_slice
