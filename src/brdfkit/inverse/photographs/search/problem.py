"""Defines the least-squares problem of the texels: residuals, their derivatives, noise and units.

A penalty draws neighbouring texels to each other: if their numbers differ by τ units, this counts
as much as a residual of one standard deviation of the noise. So noisy photographs give smooth maps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters
from brdfkit.inverse.photographs.search.normal_equations import (
    KernelObservations,
    sum_equations,
)

# Added to a Hessian, as a share of its diagonal, because undetermined numbers make it singular
RIDGE = 1e-9


@dataclass
class Equations:
    """The Gauss-Newton equations of n texels, each by itself, without differences of neighbours.

    error : the sums (n,) of weighted squared residuals.
    gradient : half of their gradients (texels, numbers) with respect to the numbers of the texel.
    hessian : half of their Gauss-Newton Hessians (texels, numbers, numbers).
    """

    error: FloatArray
    gradient: FloatArray
    hessian: FloatArray

    def damp_hessians(self, damping: FloatArray | float) -> FloatArray:
        """Return the Hessians (texels, numbers, numbers), damped so that steps are shorter.

        Their diagonals are multiplied by 1 + `damping`, and a small ridge is added.
        """
        diagonal = np.diagonal(self.hessian, axis1=1, axis2=2)
        floor = RIDGE * diagonal.max(axis=1, keepdims=True) + 1e-300
        added = np.einsum("np,pq->npq", damping * diagonal + floor, np.eye(diagonal.shape[1]))
        return self.hessian + added

    def overwrite_texels(self, texels: BoolArray, other: Equations) -> None:
        """Overwrite the equations of the `texels` in a mask (n,) by those of `other`."""
        self.error[texels] = other.error[texels]
        self.gradient[texels] = other.gradient[texels]
        self.hessian[texels] = other.hessian[texels]


@dataclass(frozen=True)
class Problem:
    """The least-squares problem of n texels of the maps, with the observations to fit.

    Methods take the searched numbers as `x` (texels, numbers), a row for each texel.

    parameters : the layout of a row.
    observed : the radiances in photographs and the directions of lights and cameras.
    report : a function that is called after each step of a search.
    """

    parameters: TexelParameters
    observed: Observations
    report: Callable[[], object] = lambda: None

    def with_observations(self, observed: Observations) -> Problem:
        """Return the same problem for other observations."""
        return replace(self, observed=observed)

    def with_radiances(self, radiance: FloatArray) -> Problem:
        """Return the same problem for other `radiance` (k, n, 3) in the photographs."""
        other = self.with_observations(replace(self.observed, radiance=radiance))
        # The directions of lights and cameras are not converted for kernels again
        other.__dict__["_photographs"] = self._photographs.with_radiances(radiance)
        return other

    def compute_errors(self, x: FloatArray) -> FloatArray:
        """Return for each texel of the maps the sum (n,) of its weighted squared residuals.

        `x` (texels, numbers) holds the searched numbers of the texels.
        """
        return sum_equations(self.parameters, x, self._photographs, differentiate=False)[0]

    def compute_equations(self, x: FloatArray) -> Equations:
        """Return the Gauss-Newton equations of each texel at the searched numbers `x`."""
        return Equations(*sum_equations(self.parameters, x, self._photographs, differentiate=True))

    @cached_property
    def _photographs(self) -> KernelObservations:
        """The observations as kernels read them."""
        return KernelObservations.collect(self.observed)

    def estimate_noise(self, errors: FloatArray) -> float:
        """Return the variance of relative radiances, from the squared residuals (n,) of texels.

        The median over texels is robust against texels that the maps do not explain.
        """
        counted = (self.observed.weights > 0).sum(axis=(0, 2))
        free = np.maximum(counted - self.parameters.count, 0.2 * counted)
        return max(float(np.median(errors / np.maximum(free, 1))), 1e-10)

    def compute_smoothness_weights(
        self, hessian: FloatArray, noise: float, tau: float
    ) -> FloatArray:
        """Return the weight of squared differences of neighbouring texels, for each number.

        The weights (numbers,) are σ² / (τ u)² for numbers with the units u, where `noise` is σ²,
        `tau` is τ, and `hessian` (texels, numbers, numbers) determines the units.
        """
        return noise / (tau * self.find_number_units(hessian)) ** 2

    def find_number_units(self, hessian: FloatArray) -> FloatArray:
        """Return a typical size of differences for each number (numbers,), from texels' Hessians.

        The unit of a weight is the weight with which its lobe alone would be as bright as the
        photographs. With the current weight as its unit, a weight near 0 could hardly change.
        """
        of_weights = slice(0, self.parameters.shape_columns.start)
        brightness = np.diagonal(hessian, axis1=1, axis2=2)[:, of_weights]
        counted = (self.observed.weights > 0).sum(axis=(0, 2))[:, None] / CHANNELS
        alone = np.sqrt(counted / np.maximum(brightness, 1e-12 * counted + 1e-300))
        units, lit = np.ones(self.parameters.count), self.observed.find_lit_channels()
        median = np.median(alone[counted[:, 0] > 0], axis=0).reshape(-1, CHANNELS)
        units[of_weights] = np.repeat(median[:, lit].mean(axis=1), CHANNELS)
        return units
