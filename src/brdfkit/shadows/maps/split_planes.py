"""Planes across the view that divide what a camera sees into slices, each with a shadow map.

For depths from n to f, plane i of m is at

    C_log = n (f/n)^(i/m),   C_uni = n + i (f - n)/m,   C_mean = (C_log + C_uni)/2

Logarithmic planes make texels equally large in the picture at all depths, but spend most slices
near the eye. Uniform planes spend most of them far away; the mean is between the two [Zhang et al.
2006], [Ergun 2008, 2.2.3.4].
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
    """Return the depths (parts + 1,) of the planes, from `near` to `far`.

    spacing : a word of `SPACINGS`.

    >>> compute_split_planes(1, 100, 2, "logarithmic")
    array([  1.,  10., 100.])
    """
    uniform = np.linspace(near, far, parts + 1)
    logarithmic = np.geomspace(near, far, parts + 1)
    mean = (uniform + logarithmic) / 2
    return {"uniform": uniform, "logarithmic": logarithmic, "mean": mean}[spacing]


def make_slice_finder(camera: Camera, planes: FloatArray) -> Callable[[JitVector], JitInt]:
    """Return a function that finds the index of the slice of the view in which a point lies.

    planes : depths of the planes between the slices, from the first to the last. Points before or
        behind all planes belong to the first or last slice.
    """
    import mitsuba as mi

    view = mi.Matrix4f(camera.view)
    inner = [dr.opaque(mi.Float, float(plane)) for plane in planes[1:-1]]
    dr.make_opaque(view)

    def find_slice(p: JitVector) -> JitInt:
        depth = -transform(view, *p)[2]
        return sum((dr.select(depth > plane, mi.UInt32(1), 0) for plane in inner), mi.UInt32(0))

    return find_slice
