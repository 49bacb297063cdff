"""Computes the Gauss-Newton equations of pixels: how photographs differ from a model, and why.

A pixel has a unit normal n, and weights a_lc of the model's lobes f_l in the channels c. Under
light i, with the irradiance E_ic, it has the radiance

    L_ic = E_ic Σ_l a_lc f_l(v, l_i) max(n · l_i, 0).

Its difference from the photographed value J_ic, in units of the scale σ (max(J_ic, 0) + δ E_ic), is
the residual u_ic. Tukey's bisquare [Beaton & Tukey 1974] of the residuals' RMS u_i over the
channels lets photographs in which a pixel lies in a shadow count little or nothing:

    ρ(u) = c²/6 (1 - (1 - u²/c²)³) for u < c, and c²/6 beyond.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import dot
from brdfkit.core.jit.double_precision import choose_float_type, to_scalar
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, mix_lobes
from brdfkit.inverse.photographs.objects.frames import evaluate_lobes, make_tangents, tilt
from brdfkit.inverse.photographs.objects.tile import Tile
from brdfkit.model import Model

CUT = 9.0  # c, the size of residuals beyond which they do not count


@dataclass(frozen=True)
class Reflection:
    """What the pixels of a tile reflect: a model, its shape parameters, and how errors count.

    model : the model's class.
    shapes : the shape parameters by name, one value or one for each pixel.
    dark_offset : δ, the share of the irradiance that is added to values before errors are divided
        by them, so that relative errors of dark pixels stay finite.
    """

    model: type[Model]
    shapes: Mapping[str, JitFloat]
    dark_offset: float

    @property
    def lobe_count(self) -> int:
        """The number of lobes."""
        return len(self.model.weights())


@dataclass(frozen=True)
class Prior:
    """What is known of pixels besides their photographs.

    weights : the expected weights, by channel and lobe.
    spreads : the standard deviations from them; infinite where nothing is known.
    normals : the expected normals, or None.
    normal_spread : the standard deviation from them [radians].
    """

    weights: list[list[JitFloat]]
    spreads: list[list[JitFloat]]
    normals: JitVector | None = None
    normal_spread: float = 1.0


@dataclass(frozen=True)
class Equations:
    """The Gauss-Newton equations of n pixels, for their weights a and the slopes p, q of n.

    weight_matrix : (channels, lobes, lobes), the second derivatives with respect to the weights.
    coupling : (channels, lobes, 2), those with respect to a weight and a slope.
    slope_matrix : (3,), those with respect to p p, p q and q q.
    weight_gradient : (channels, lobes).
    slope_gradient : (2,).
    loss : Σ_i ρ(u_i), with the prior's share.
    lights : the number of photographs that count, the sum of their weights.
    """

    weight_matrix: list[list[list[JitFloat]]]
    coupling: list[list[list[JitFloat]]]
    slope_matrix: list[JitFloat]
    weight_gradient: list[list[JitFloat]]
    slope_gradient: list[JitFloat]
    loss: JitFloat
    lights: JitFloat


def compute_equations(
    tile: Tile,
    reflection: Reflection,
    n: JitVector,
    a: list[list[JitFloat]],
    scale: float,
    prior: Prior | None = None,
) -> Equations:
    """Return the equations of a tile's pixels with the normals n and the weights a.

    `scale` is σ, the typical size of relative residuals. One kernel adds up all photographs.
    """
    real = choose_float_type()
    whole = dr.uint32_array_t(real)
    lobes = range(reflection.lobe_count)
    zero: JitFloat = dr.zeros(real, tile.count)
    sums: list[Any] = [
        [[[zero + 0 for _ in lobes] for _ in lobes] for _ in range(CHANNELS)],
        [[[zero + 0, zero + 0] for _ in lobes] for _ in range(CHANNELS)],
        [zero + 0 for _ in range(3)],
        [[zero + 0 for _ in lobes] for _ in range(CHANNELS)],
        [zero + 0, zero + 0],
        zero + 0,
        zero + 0,
    ]
    inverse_scale, offset = to_scalar(1 / scale), to_scalar(reflection.dark_offset)
    end = dr.opaque(whole, len(tile.exposures))

    def add_photograph(light: JitFloat, sums: list[Any]) -> tuple[JitFloat, list[Any]]:
        """Add the share of one photograph to the sums."""
        to_light, irradiance = tile.illuminate(light)
        values, counts = tile.read_values(light)
        lobe_values, slopes = _differentiate_lobes(tile, reflection, n, to_light)
        # a channel without light tells nothing
        factors = [
            dr.select(e > 0, 1 / (dr.maximum(v, 0) + offset * e), 0)
            for v, e in zip(values, irradiance, strict=True)
        ]
        counts &= sum(irradiance) > 0
        residuals = [
            factors[c] * (irradiance[c] * mix_lobes(a[c], lobe_values) - values[c])
            for c in range(CHANNELS)
        ]
        square = sum(r * r for r in residuals) * (inverse_scale * inverse_scale / CHANNELS)
        y = dr.minimum(square / CUT**2, 1)
        w = dr.select(counts, (1 - y) * (1 - y), 0)
        matrix, coupling, slope_matrix, gradient, slope_gradient, loss, lights = sums
        loss = loss + dr.select(counts, CUT**2 * (1 - (1 - y) * (1 - y) * (1 - y)), 0)
        lights = lights + w
        for c in range(CHANNELS):
            scaled = factors[c] * irradiance[c]
            p, q = (mix_lobes(a[c], slope) * scaled for slope in slopes)
            rows = [value * scaled for value in lobe_values]
            matrix[c] = [[matrix[c][k][m] + w * rows[k] * rows[m] for m in lobes] for k in lobes]
            coupling[c] = [
                [coupling[c][k][0] + w * rows[k] * p, coupling[c][k][1] + w * rows[k] * q]
                for k in lobes
            ]
            slope_matrix = [
                entry + w * product
                for entry, product in zip(slope_matrix, (p * p, p * q, q * q), strict=True)
            ]
            gradient[c] = [gradient[c][k] + w * rows[k] * residuals[c] for k in lobes]
            slope_gradient = [
                entry + w * slope * residuals[c]
                for entry, slope in zip(slope_gradient, (p, q), strict=True)
            ]
        return light + 1, [matrix, coupling, slope_matrix, gradient, slope_gradient, loss, lights]

    _, sums = dr.while_loop(
        (dr.zeros(whole, tile.count), sums), lambda light, _sums: light < end, add_photograph
    )
    equations = Equations(*sums)
    return equations if prior is None else _add_prior(equations, prior, n, a, scale)


def _differentiate_lobes(
    tile: Tile, reflection: Reflection, n: JitVector, to_light: JitVector
) -> tuple[list[JitFloat], list[list[JitFloat]]]:
    """Return the lobes at the normals n, and their derivatives with respect to both slopes."""
    real = choose_float_type()
    tangents, slopes = make_tangents(n), []
    # within a loop that is recorded, derivatives are switched off unless they are resumed
    with dr.resume_grad():
        for along in ((1.0, 0.0), (0.0, 1.0)):
            slope: JitFloat = dr.zeros(real, tile.count)
            dr.enable_grad(slope)
            tilted = tilt(n, *tangents, along[0] * slope, along[1] * slope)
            lobes = evaluate_lobes(
                reflection.model, reflection.shapes, tilted, tile.to_camera, to_light
            )
            dr.forward_from(slope)
            slopes.append([dr.grad(lobe) for lobe in lobes])
        return [dr.detach(lobe) for lobe in lobes], slopes


def _add_prior(
    equations: Equations, prior: Prior, n: JitVector, a: list[list[JitFloat]], scale: float
) -> Equations:
    """Return the equations with squared differences from what is known besides."""
    square = to_scalar(scale**2)
    loss, slope_matrix, slope_gradient = (
        equations.loss,
        equations.slope_matrix,
        equations.slope_gradient,
    )
    matrix = [[list(row) for row in rows] for rows in equations.weight_matrix]
    gradient = [list(row) for row in equations.weight_gradient]
    for c in range(CHANNELS):
        for k, weight in enumerate(a[c]):
            away = weight - prior.weights[c][k]
            strength = 1 / (prior.spreads[c][k] * prior.spreads[c][k])
            loss = loss + strength * away * away
            matrix[c][k][k] = matrix[c][k][k] + square * strength
            gradient[c][k] = gradient[c][k] + square * strength * away
    if prior.normals is not None:
        strength = to_scalar(1 / prior.normal_spread**2)
        away = n - prior.normals
        loss = loss + strength * dot(away, away)
        own = square * strength
        p, pq, q = slope_matrix
        slope_matrix = [p + own, pq, q + own]
        slope_gradient = [
            entry + own * dot(away, tangent)
            for entry, tangent in zip(slope_gradient, make_tangents(n), strict=True)
        ]
    return Equations(
        matrix,
        equations.coupling,
        slope_matrix,
        gradient,
        slope_gradient,
        loss,
        equations.lights,
    )
