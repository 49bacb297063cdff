"""Finds normals and albedos of a matt object as a start: photometric stereo [Woodham 1980].

A matt pixel with the albedo ρ has the value J_i = E_i ρ/π (n · l_i), so its vector b = ρ n / π is
linear in the photographs. Highlights and shadows deviate from that. Least absolute differences,
found by reweighted least squares, hardly follow them, and values in shadows do not count.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.geometry.vectors import dot, normalise
from brdfkit.core.jit.double_precision import Vector, choose_float_type, to_scalar
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.objects.tile import Tile, to_numpy

ROUNDS = 20  # rounds of reweighting
# Differences below this share of the typical brightness count as 0
SMALLEST_DIFFERENCE = 0.01
DARK = 0.02  # values below this share of the typical brightness are in a shadow
LEAST_LEAN = 0.05  # smallest z of the normals, since the camera sees the surface from its front


def estimate_normals(
    tile: Tile, brightness: float, robust: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Return unit normals (n, 3) and albedos (n, 3) in red, green and blue of a tile's pixels.

    `brightness` is the typical ratio of a photograph's values to the irradiance. Unless `robust`,
    they are those of plain least squares, in which highlights and shadows count.
    """
    real = choose_float_type()
    b = Vector(*(dr.zeros(real, tile.count) for _ in range(3)))
    smallest, dark = to_scalar(SMALLEST_DIFFERENCE * brightness), to_scalar(DARK * brightness)
    for round_number in range(ROUNDS if robust else 1):
        sums: list[JitFloat] = [dr.zeros(real, tile.count) for _ in range(9)]
        weighs = robust and round_number > 0

        def add(
            light: JitFloat,
            sums: list[JitFloat],
            b: Vector = b,
            weighs: bool = weighs,
        ) -> tuple[JitFloat, list[JitFloat]]:
            """Add the share of one photograph to the normal equations."""
            w, irradiance = tile.illuminate(light)
            values, counts = tile.read_values(light)
            power = sum(irradiance)
            value = dr.select(power > 0, sum(values) / power, 0)
            weight = dr.select(counts & (power > 0) & ((value > dark) | (not robust)), 1.0, 0.0)
            if weighs:
                weight = weight / (dr.abs(value - dot(b, w)) + smallest)
            products = w.x * w.x, w.x * w.y, w.x * w.z, w.y * w.y, w.y * w.z, w.z * w.z
            terms = [*products, w.x * value, w.y * value, w.z * value]
            return light + 1, [s + weight * t for s, t in zip(sums, terms, strict=True)]

        sums = _loop(tile, add, sums)
        b = _solve(sums)
        dr.eval(b.x, b.y, b.z)
    front = b.z > LEAST_LEAN * dr.sqrt(dot(b, b))
    n = Vector(dr.select(front, b.x, 0), dr.select(front, b.y, 0), dr.select(front, b.z, 1))
    n = normalise(n)
    dr.eval(n.x, n.y, n.z)
    return to_numpy(n), _estimate_albedos(tile, n, robust)


def _estimate_albedos(tile: Tile, n: Vector, robust: bool) -> FloatArray:
    """Return the albedos (n, 3) of a tile's pixels with the normals n, by least squares."""
    real = choose_float_type()

    def add(light: JitFloat, sums: list[JitFloat]) -> tuple[JitFloat, list[JitFloat]]:
        """Add the share of one photograph to the sums."""
        w, irradiance = tile.illuminate(light)
        values, counts = tile.read_values(light)
        cosine = dr.select(counts, dr.maximum(dot(n, w), 0), 0)
        if robust:  # lights that graze the surface come with shadows
            cosine = dr.select(cosine > 0.2, cosine, 0)
        channels = list(zip(values, irradiance, strict=True))
        shares = [dr.select(e > 0, cosine * v / e, 0) for v, e in channels]
        squares = [dr.select(e > 0, cosine * cosine, 0) for e in irradiance]
        return light + 1, [s + t for s, t in zip(sums, [*shares, *squares], strict=True)]

    sums = _loop(tile, add, [dr.zeros(real, tile.count) for _ in range(2 * CHANNELS)])
    pairs = zip(sums[:CHANNELS], sums[CHANNELS:], strict=True)
    albedos = [np.pi * np.array(dr.maximum(v, 0) / dr.maximum(s, 1e-9)) for v, s in pairs]
    return np.stack(albedos, axis=1)


def _loop(tile: Tile, add: Callable[..., Any], sums: list[JitFloat]) -> list[JitFloat]:
    """Return the sums over all lights of a tile."""
    whole = dr.uint32_array_t(choose_float_type())
    end = dr.opaque(whole, len(tile.exposures))
    state = dr.zeros(whole, tile.count), sums
    return dr.while_loop(state, lambda light, _sums: light < end, add)[1]


def _solve(sums: list[JitFloat]) -> Vector:
    """Return the solution of symmetric systems with three unknowns, by cofactors.

    `sums` are the matrix's elements xx, xy, xz, yy, yz, zz and the right side.
    """
    xx, xy, xz, yy, yz, zz, p, q, r = sums
    ridge = 1e-9 * (xx + yy + zz) + 1e-30
    xx, yy, zz = xx + ridge, yy + ridge, zz + ridge
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    determinant = xx * a + xy * b + xz * c
    inverse = 1 / dr.select(dr.abs(determinant) > 1e-60, determinant, 1)
    return Vector(
        (a * p + b * q + c * r) * inverse,
        (b * p + d * q + e * r) * inverse,
        (c * p + e * q + f * r) * inverse,
    )
