"""Adds up the Gauss-Newton equations of texels over all photographs, in one kernel.

A texel has the weights a_lc of the lobes f_l in the channels c, and the numbers s_j of its shapes
and its normal. In photograph i, with the irradiance E_ic, the photographed radiance J_ic and the
weight w_ic of its squared error, its residual and the residual's derivatives are

    r_ic = E_ic Σ_l a_lc f_li - J_ic,
    ∂r_ic/∂a_lc = E_ic f_li,   ∂r_ic/∂s_j = E_ic Σ_l a_lc ∂f_li/∂s_j,

where f_li includes the cosine of the light. The sums of w r², w r ∂r and w ∂r ∂r have a place of
their own for each texel, so that a kernel runs over the texels and loops over the photographs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.jit.double_precision import Vector, choose_float_type, to_array
from brdfkit.core.jit.padding import pad
from brdfkit.core.jit.threads import in_turn
from brdfkit.inverse.photographs.capture.observations import ARRAYS, Observations
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters, mix_lobes

BLOCK = 131_072  # number of texels in a kernel, to limit the memory


@dataclass(frozen=True)
class KernelObservations:
    """The observations of n texels in k photographs, as kernels read them.

    planes : for each name of `ARRAYS` three arrays (k · n) in single precision, x, y and z or red,
        green and blue.
    lights : k, the number of photographs.
    texels : n, the number of texels.
    """

    planes: dict[str, list[Any]]
    lights: int
    texels: int

    @classmethod
    def collect(cls, observed: Observations) -> KernelObservations:
        """Return the observations for kernels."""
        lights, texels = observed.radiance.shape[:2]
        planes = {name: _split_into_planes(getattr(observed, name)) for name in ARRAYS}
        return cls(planes, lights, texels)

    def with_radiances(self, radiance: FloatArray) -> KernelObservations:
        """Return the same observations with other radiances (k, n, 3) in the photographs."""
        return replace(self, planes=self.planes | {"radiance": _split_into_planes(radiance)})

    def read(self, name: str, place: Any) -> list[JitFloat]:
        """Return three numbers of each texel, in double precision."""
        real = choose_float_type()
        return [real(dr.gather(type(plane), plane, place)) for plane in self.planes[name]]


def _split_into_planes(values: FloatArray) -> list[Any]:
    """Return each of the three components of `values` (k, n, 3) as an array of Dr.Jit."""
    single: Any = dr.float32_array_t(choose_float_type())
    planes = (np.ravel(values[..., axis]).astype(np.float32) for axis in range(CHANNELS))
    return [single(pad(plane)) for plane in planes]


@in_turn
def sum_equations(
    parameters: TexelParameters, x: FloatArray, observed: KernelObservations, differentiate: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the errors (n,), gradients (n, numbers) and Hessians (n, numbers, numbers) of texels.

    `x` (n, numbers) are the searched numbers of the texels. Unless `differentiate`, the gradients
    and Hessians are empty. Gradients and Hessians are half of those of the sum of squared errors.
    """
    count = parameters.count if differentiate else 0
    error = np.empty(len(x))
    gradient, hessian = np.empty((len(x), count)), np.empty((len(x), count, count))
    for first in range(0, len(x), BLOCK):
        rows = slice(first, min(first + BLOCK, len(x)))
        sums, products = _sum_over_photographs(parameters, x[rows], first, observed, differentiate)
        dr.eval(sums, products)
        error[rows] = np.array(sums)
        if differentiate:
            flat_gradient, flat_hessian = _store(parameters, products, len(x[rows]))
            gradient[rows] = np.array(flat_gradient).reshape(-1, count)
            hessian[rows] = np.array(flat_hessian).reshape(-1, count, count)
    return error, gradient, hessian


def _store(
    parameters: TexelParameters, products: list[list[list[JitFloat]]], texels: int
) -> tuple[JitFloat, JitFloat]:
    """Return the gradients and Hessians of texels, texel by texel, from sums for each channel."""
    real = choose_float_type()
    whole = dr.uint32_array_t(real)
    count = parameters.count
    gradients: dict[int, JitFloat] = {}
    hessians: dict[tuple[int, int], JitFloat] = {}
    for own, sums in zip(_find_columns(parameters), products, strict=False):
        for k, (column, row) in enumerate(zip(own, sums, strict=True)):
            gradients[column] = gradients.get(column, 0) + row[0]
            for other, product in zip(own[k:], row[1:], strict=True):
                hessians[column, other] = hessians.get((column, other), 0) + product
    texel = dr.arange(whole, texels)
    gradient: JitFloat = dr.zeros(real, texels * count)
    hessian: JitFloat = dr.zeros(real, texels * count**2)
    for column, value in gradients.items():
        dr.scatter(gradient, value, texel * count + column)
    for (column, other), value in hessians.items():
        for place in {column * count + other, other * count + column}:
            dr.scatter(hessian, value, texel * count**2 + place)
    return gradient, hessian


def _find_columns(parameters: TexelParameters) -> list[list[int]]:
    """Return the columns of the numbers that each channel depends on: its weights, all shapes."""
    shapes = list(range(parameters.shape_columns.start, parameters.count))
    lobes = range(len(parameters.lobes))
    return [[CHANNELS * lobe + c for lobe in lobes] + shapes for c in range(CHANNELS)]


def _sum_over_photographs(
    parameters: TexelParameters,
    x: FloatArray,
    first: int,
    observed: KernelObservations,
    differentiate: bool,
) -> tuple[JitFloat, list[list[list[JitFloat]]]]:
    """Return the sum of w r², and for each channel those of w ∂r r and w ∂r ∂r.

    `x` belongs to the texels from index `first` on. A channel has a row for each number that it
    depends on: the product with the residual, and those with the numbers from its own one on.
    """
    real = choose_float_type()
    whole = dr.uint32_array_t(real)
    lobes, start = len(parameters.lobes), parameters.shape_columns.start
    weights = [[to_array(x[:, CHANNELS * k + c]) for k in range(lobes)] for c in range(CHANNELS)]
    numbers = [to_array(column) for column in x[:, start:].T]
    fixed = parameters.make_fixed_values()
    size = lobes + len(numbers)
    zero: JitFloat = dr.zeros(real, len(x))
    products = [
        [[zero + 0 for _ in range(size - k + 1)] for k in range(size)] for _ in range(CHANNELS)
    ]
    texel = dr.arange(whole, len(x)) + dr.opaque(whole, first)
    step, end = dr.opaque(whole, observed.texels), dr.opaque(whole, observed.lights)

    def add_photograph(light: Any, sums: list[Any]) -> tuple[Any, list[Any]]:
        """Add the share of one photograph to the sums."""
        place = light * step + texel
        to_light = Vector(*observed.read("to_light", place))
        to_camera = Vector(*observed.read("to_camera", place))
        irradiance, radiance, w = (
            observed.read(name, place) for name in ("irradiance", "radiance", "weights")
        )
        values, slopes = parameters.evaluate_lobes(
            numbers, fixed, to_light, to_camera, differentiate
        )
        error, products = sums
        for c in range(CHANNELS):
            residual = irradiance[c] * mix_lobes(weights[c], values) - radiance[c]
            error = error + w[c] * residual * residual
            if not differentiate:
                continue
            columns = [irradiance[c] * f for f in values]
            columns += [irradiance[c] * mix_lobes(weights[c], slope) for slope in slopes]
            for k, column in enumerate(columns):
                scaled = w[c] * column
                factors = [residual, *columns[k:]]
                products[c][k] = [
                    total + scaled * factor
                    for total, factor in zip(products[c][k], factors, strict=True)
                ]
        return light + 1, [error, products]

    state = [zero + 0, products if differentiate else []]
    _, sums = dr.while_loop(
        (dr.zeros(whole, len(x)), state), lambda light, _sums: light < end, add_photograph
    )
    return sums[0], sums[1]
