"""Computes frames around normals, and the lobes of a model for pixels with such normals."""

from collections.abc import Mapping

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import dot, normalise
from brdfkit.core.jit.double_precision import Vector
from brdfkit.inverse.photographs.maps.texel_parameters import evaluate_cosine_lobes
from brdfkit.model import Model


def make_tangents(n: JitVector) -> tuple[JitVector, JitVector]:
    """Return two unit tangents that form a frame with a unit normal [Duff et al. 2017]."""
    sign = dr.select(n.z < 0, -1.0, 1.0)
    a = -1 / (sign + n.z)
    b = n.x * n.y * a
    return (
        Vector(1 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vector(b, sign + n.y * n.y * a, -n.y),
    )


def tilt(n: JitVector, t: JitVector, b: JitVector, p: JitFloat, q: JitFloat) -> JitVector:
    """Return a unit normal that is tilted by the slopes p and q along its tangents t and b."""
    return normalise(n + t * p + b * q)


def evaluate_lobes(
    model: type[Model],
    shapes: Mapping[str, JitFloat],
    n: JitVector,
    to_camera: JitVector,
    to_light: JitVector,
) -> list[JitFloat]:
    """Return each lobe of a model times the cosine of the light, at pixels with the normals n.

    `shapes` holds the model's shape parameters by name. Lobes are 0 where the light or the camera
    is behind the surface.
    """
    t, b = make_tangents(n)
    wi, wo = (Vector(dot(w, t), dot(w, b), dot(w, n)) for w in (to_camera, to_light))
    return evaluate_cosine_lobes(model, shapes, wi, wo)
