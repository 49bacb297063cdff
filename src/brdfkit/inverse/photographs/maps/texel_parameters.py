"""Defines which numbers are searched for a texel of the maps, and computes its radiances.

A texel has the weights a_l of the BRDF model's lobes l in red, green and blue, the shape
parameters, and x and y of its normal n. Light i arrives from the direction l_i and would cause the
irradiance E_i on a surface facing it; v is the direction to the camera, and the lobes f_l are
evaluated in the texel's frame around n. The texel then has the radiance

    L_i = E_i max(n · l_i, 0) Σ_l a_l f_l(v, l_i).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitMask, JitVector
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.threads import in_turn
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE, ShapeParameters
from brdfkit.model import Model

STEEPEST_SLANT = 0.65  # largest |x| and |y| of the unit normals that a search tries
CHANNELS = 3
SMALLEST_COSINE = 1e-3  # light and view that graze the surface more have no radiance


@dataclass(frozen=True)
class TexelParameters:
    """The layout of the numbers that are searched for each texel of maps, for one BRDF model.

    The numbers of a texel form a row: the weights (lobe by lobe, red, green and blue), the shape
    parameters as `ShapeParameters` converts them, and x and y of the normal.

    model : the model's class.
    names : the names of the shape parameters that are searched.
    fixed : the values of the other shape parameters.
    pair : the names of two lobe widths whose directions turn about the normal, or None.
    """

    model: type[Model]
    names: tuple[str, ...]
    fixed: dict[str, float]
    pair: tuple[str, str] | None = None

    @property
    def lobes(self) -> tuple[str, ...]:
        """The names of the weights of the model's lobes."""
        return tuple(self.model.weights())

    @property
    def shapes(self) -> ShapeParameters:
        """The shape parameters that are searched, with their conversion to numbers."""
        return ShapeParameters(self.model, self.names, self.pair)

    @property
    def shape_columns(self) -> slice:
        """The columns that the shape parameters have in a texel's row of numbers."""
        first = CHANNELS * len(self.lobes)
        return slice(first, first + len(self.shapes.number_names))

    @property
    def normal_columns(self) -> slice:
        """The columns that x and y of the normal have in a texel's row of numbers."""
        return slice(self.shape_columns.stop, self.shape_columns.stop + 2)

    @property
    def count(self) -> int:
        """How many numbers are searched for each texel."""
        return int(self.normal_columns.stop)

    @property
    def number_names(self) -> list[str]:
        """A name for each number of a texel, such as "diffuse_reflectance[0]"."""
        weights = [f"{name}[{c}]" for name in self.lobes for c in range(CHANNELS)]
        return [*weights, *self.shapes.number_names, "normal[x]", "normal[y]"]

    def find_limits(self) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and the highest value of each searched number, both (numbers,)."""
        low, high = np.zeros(self.count), np.full(self.count, np.inf)
        low[self.shape_columns], high[self.shape_columns] = self.shapes.find_limits()
        low[self.normal_columns], high[self.normal_columns] = -STEEPEST_SLANT, STEEPEST_SLANT
        return low, high

    def compute_radiances(self, x: FloatArray, observed: Observations) -> FloatArray:
        """Return the radiances (lights, n, 3) of n texels with searched numbers `x` (n, numbers).

        `observed` holds the directions of the lights and cameras, and the irradiances.
        """
        lobes = self._compute_lobes(x, observed)
        weights = x[:, : self.shape_columns.start].reshape(len(x), -1, CHANNELS)
        shown = sum(lobe[..., None] * weights[:, k] for k, lobe in enumerate(lobes))
        radiances: FloatArray = shown * observed.irradiance
        return radiances

    @in_turn
    def _compute_lobes(self, x: FloatArray, observed: Observations) -> list[FloatArray]:
        """Return the radiances (lights, n) of each lobe, at weight 1 and irradiance 1."""
        lights, texels = observed.to_light.shape[:2]
        numbers = [
            double_precision.to_array(np.tile(column, lights))
            for column in x[:, self.shape_columns.start : self.normal_columns.stop].T
        ]
        to_light = double_precision.to_vector(observed.to_light.reshape(-1, 3))
        to_camera = double_precision.to_vector(observed.to_camera.reshape(-1, 3))
        lobes, _ = self.evaluate_lobes(
            numbers, self.make_fixed_values(), to_light, to_camera, differentiate=False
        )
        dr.eval(lobes)
        return [np.array(lobe).reshape(lights, texels) for lobe in lobes]

    def make_fixed_values(self) -> dict[str, JitFloat]:
        """Return the shape parameters with one value everywhere, as arrays of Dr.Jit."""
        return {name: double_precision.to_scalar(value) for name, value in self.fixed.items()}

    def evaluate_lobes(
        self,
        numbers: list[JitFloat],
        fixed: Mapping[str, JitFloat],
        to_light: JitVector,
        to_camera: JitVector,
        differentiate: bool = True,
    ) -> tuple[list[JitFloat], list[list[JitFloat]]]:
        """Return each lobe times the cosine to the normal, and derivatives by each number.

        `numbers` holds the searched numbers of the shape parameters, and x and y of the normal, in
        arrays of Dr.Jit; `fixed` is from `make_fixed_values`. There are no derivatives unless
        `differentiate`. A kernel's loop may call this method.
        """
        if not differentiate:
            return self._evaluate_in_drjit(numbers, fixed, to_light, to_camera), []
        # Within a loop that is recorded, derivatives are switched off unless they are resumed
        with dr.resume_grad():
            # The sums are new arrays, because those from outside of the loop cannot be changed
            numbers = [number + 0 for number in numbers]
            for number in numbers:
                dr.enable_grad(number)
            lobes = self._evaluate_in_drjit(numbers, fixed, to_light, to_camera)
            derivatives = []
            for number in numbers:
                dr.clear_grad(lobes)
                dr.set_grad(number, 1)
                dr.enqueue(dr.ADMode.Forward, number)
                dr.traverse(dr.ADMode.Forward, dr.ADFlag.ClearInterior)
                derivatives.append([dr.grad(lobe) for lobe in lobes])
            return [dr.detach(lobe) for lobe in lobes], derivatives

    def _evaluate_in_drjit(
        self,
        numbers: list[JitFloat],
        fixed: Mapping[str, JitFloat],
        to_light: JitVector,
        to_camera: JitVector,
    ) -> list[JitFloat]:
        """Return each lobe times the cosine to the normal; see `evaluate_lobes`."""
        *shapes, x, y = numbers
        z = dr.sqrt(dr.maximum(1 - x * x - y * y, 1e-4))
        normal = double_precision.Vector(x, y, z)
        # The tangent is the x axis projected onto the surface, as in Mitsuba's normal maps
        scale = dr.rsqrt(dr.maximum(1 - x * x, 1e-4))
        tangent = double_precision.Vector((1 - x * x) * scale, -x * y * scale, -x * z * scale)
        values = self.shapes.to_parameter_values(shapes, dr)
        if self.pair:
            sine, cosine = dr.sincos(values.pop(ANGLE))
            tangent = tangent * cosine + _cross_product(normal, tangent) * sine
        frame = tangent, _cross_product(normal, tangent), normal
        wi, wo = _to_frame_coordinates(to_camera, frame), _to_frame_coordinates(to_light, frame)
        return evaluate_cosine_lobes(self.model, {**values, **fixed}, wi, wo)


def evaluate_cosine_lobes(
    model: type[Model], values: Mapping[str, Any], wi: JitVector, wo: JitVector
) -> list[JitFloat]:
    """Return each lobe of a model times the cosine of the light at `wo`, for a viewer at `wi`.

    `values` holds the model's shape parameters by name. Lobes are 0 where the light or the viewer
    is behind the surface.
    """
    lit = (wi.z > SMALLEST_COSINE) & (wo.z > SMALLEST_COSINE)
    up = double_precision.Vector(0, 0, 1)
    wi, wo = _select_vector(lit, wi, up), _select_vector(lit, wo, up)
    lobes = [lobe for _, lobe in model.bind(dict(values)).terms()]
    return [dr.select(lit, (lobe.eval(wi, wo) + 0 * wo.z) * wo.z, 0) for lobe in lobes]


def mix_lobes(weights: Sequence[JitFloat], lobes: Sequence[JitFloat]) -> JitFloat:
    """Return the sum of lobes times their weights."""
    return sum(weight * lobe for weight, lobe in zip(weights, lobes, strict=True))


def _cross_product(a: JitVector, b: JitVector) -> JitVector:
    """Return the cross product of two vectors."""
    return double_precision.Vector(
        a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x
    )


def _to_frame_coordinates(w: JitVector, frame: tuple[JitVector, JitVector, JitVector]) -> JitVector:
    """Return the coordinates of a vector in a frame of tangent, bitangent and normal."""
    return double_precision.Vector(*(w.x * a.x + w.y * a.y + w.z * a.z for a in frame))


def _select_vector(condition: JitMask, a: JitVector, b: JitVector) -> JitVector:
    """Return the vector `a` where a condition holds, else `b`."""
    return double_precision.Vector(
        *(dr.select(condition, getattr(a, k), getattr(b, k)) for k in "xyz")
    )
