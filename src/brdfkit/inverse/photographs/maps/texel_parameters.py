"""The numbers of a texel that are searched, and how they make its radiances.

Of a texel: the weights of the model's lobes, in red, green and blue, the shape parameters, and x
and y of the normal. With irradiances E_i from directions l_i, and the texel's frame about n:

    L_i = E_i max(n · l_i, 0) Σ_l a_l f_l(v, l_i)
"""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from brdfkit.core.jit import double_precision
from brdfkit.core.jit.threads import in_turn
from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE, Shapes

STEEPEST = 0.65  # the largest x or y of a normal
CHANNELS = 3


@dataclass(frozen=True)
class Numbers:
    """The numbers of a `model` whose shape parameters `names` are searched, and others `fixed`.

    Of each texel a row: weights (lobe by lobe, red, green and blue), the numbers of the `form`, the
    shape parameters, and the normal's x and y. `pair`: those that turn about the normal, if any.
    """

    model: type
    names: tuple[str, ...]
    fixed: dict[str, float]
    pair: tuple[str, str] | None = None

    @property
    def lobes(self):
        """The names of the weights."""
        return self.model.weights()

    @property
    def form(self):
        """The `Shapes`."""
        return Shapes(self.model, self.names, self.pair)

    @property
    def shapes(self):
        """Where the shapes are in a row."""
        first = CHANNELS * len(self.lobes)
        return slice(first, first + len(self.form.columns))

    @property
    def normal(self):
        """Where x and y of the normal are in a row."""
        return slice(self.shapes.stop, self.shapes.stop + 2)

    @property
    def count(self):
        """How many numbers a texel has."""
        return self.normal.stop

    def limits(self):
        """(low, high), each (count,)."""
        low, high = np.zeros(self.count), np.full(self.count, np.inf)
        low[self.shapes], high[self.shapes] = self.form.limits()
        low[self.normal], high[self.normal] = -STEEPEST, STEEPEST
        return low, high

    @in_turn
    def radiances(self, x, seen, slopes=True):
        """By lobe, arrays (k, n): the radiances of each under a weight of 1 and irradiance of 1;
        and their derivatives by shapes and normal, a list for each of these, of rows `x` (n, count)
        seen as `Observations`."""
        lights, texels = seen.to_light.shape[:2]
        arrays = [
            double_precision.to_array(np.tile(column, lights))
            for column in x[:, self.shapes.start : self.normal.stop].T
        ]
        to_light = double_precision.to_vector(seen.to_light.reshape(-1, 3))
        to_camera = double_precision.to_vector(seen.to_camera.reshape(-1, 3))
        shape = (lights, texels)
        if slopes:
            for one in arrays:
                dr.enable_grad(one)
        found = self._lobes(arrays, to_light, to_camera)
        values, by_number = [dr.detach(lobe) for lobe in found], []
        for one in arrays if slopes else ():
            dr.clear_grad(found)
            dr.set_grad(one, 1)
            dr.enqueue(dr.ADMode.Forward, one)
            dr.traverse(dr.ADMode.Forward, dr.ADFlag.ClearInterior)
            by_number.append([dr.grad(lobe) for lobe in found])
        dr.eval(values, by_number)  # all of them in one kernel

        def plain(lobes):
            return [np.array(lobe).reshape(shape) for lobe in lobes]

        return plain(values), [plain(lobes) for lobes in by_number]

    def _lobes(self, arrays, to_light, to_camera):
        """Each lobe times the cosine, at shapes and normals, `arrays` over lights and texels."""
        *shapes, x, y = arrays
        z = dr.sqrt(dr.maximum(1 - x * x - y * y, 1e-4))
        normal = double_precision.Vector(x, y, z)
        # the tangent is the x axis, laid onto the surface, as Mitsuba's normal maps have it
        scale = dr.rsqrt(dr.maximum(1 - x * x, 1e-4))
        tangent = double_precision.Vector((1 - x * x) * scale, -x * y * scale, -x * z * scale)
        values = self.form.values(shapes, dr)
        if self.pair:
            sine, cosine = dr.sincos(values.pop(ANGLE))
            tangent = _turned(tangent, _cross(normal, tangent), cosine, sine)
        bitangent = _cross(normal, tangent)
        wi = _local(to_camera, tangent, bitangent, normal)
        wo = _local(to_light, tangent, bitangent, normal)
        lit = (wi.z > 1e-3) & (wo.z > 1e-3)
        up = double_precision.Vector(0 * x, 0 * x, 0 * x + 1)
        wi, wo_ = _where(lit, wi, up), _where(lit, wo, up)
        values |= {name: double_precision.to_scalar(v) for name, v in self.fixed.items()}
        lobes = [lobe for _, lobe in self.model.bind(values).terms()]
        return [dr.select(lit, (lobe.eval(wi, wo_) + 0 * x) * wo_.z, 0) for lobe in lobes]


def _cross(a, b):
    return double_precision.Vector(
        a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x
    )


def _turned(u, v, cosine, sine):
    return double_precision.Vector(*(cosine * getattr(u, k) + sine * getattr(v, k) for k in "xyz"))


def _dot(a, b):
    return a.x * b.x + a.y * b.y + a.z * b.z


def _local(w, tangent, bitangent, normal):
    return double_precision.Vector(_dot(w, tangent), _dot(w, bitangent), _dot(w, normal))


def _where(condition, a, b):
    return double_precision.Vector(
        *(dr.select(condition, getattr(a, k), getattr(b, k)) for k in "xyz")
    )
