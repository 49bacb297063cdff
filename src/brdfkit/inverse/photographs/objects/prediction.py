"""Predicts the photographs of fitted pixels under lights, and compares them with real ones."""

from __future__ import annotations

from collections.abc import Iterator

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.geometry.vectors import dot
from brdfkit.core.jit.double_precision import choose_float_type, to_vector
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, mix_lobes
from brdfkit.inverse.photographs.objects.equations import Reflection
from brdfkit.inverse.photographs.objects.fit_pixels import split_weights
from brdfkit.inverse.photographs.objects.frames import evaluate_lobes
from brdfkit.inverse.photographs.objects.tile import Tile

TINY = 1e-30  # smallest value by which differences are divided


def predict(
    tile: Tile, reflection: Reflection, normals: FloatArray, weights: FloatArray
) -> Iterator[tuple[FloatArray, BoolArray]]:
    """Yield for each light of a tile the radiances (n, 3), and which pixels (n,) face the light."""
    whole = dr.uint32_array_t(choose_float_type())
    n, a = to_vector(normals), split_weights(weights)
    for number in range(len(tile.exposures)):
        to_light, irradiance = tile.illuminate(dr.opaque(whole, number))
        lobes = evaluate_lobes(reflection.model, reflection.shapes, n, tile.to_camera, to_light)
        radiances = [irradiance[c] * mix_lobes(a[c], lobes) for c in range(CHANNELS)]
        faces = dot(n, to_light) > 0
        dr.eval(radiances, faces)
        yield np.stack([np.array(r) for r in radiances], axis=1), np.array(faces)


def compute_relative_differences(
    predicted: FloatArray, values: FloatArray, floor: FloatArray | float = 0.0
) -> FloatArray:
    """Return the differences of predictions (n, 3) from photographed values, relative to these.

    `floor` is added to the values, so that relative differences of dark pixels stay finite.
    """
    return (predicted - values) / np.maximum(np.maximum(values, 0) + floor, TINY)


def predict_photographs(
    capture: ObjectCapture,
    reflection: Reflection,
    normals: FloatArray,
    weights: FloatArray,
) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return predictions (n, 3) and photographed values (n, 3) of pixels, by photographs' names.

    Pixels that face away from the light and values that do not count are left out. Shadows that one
    part of an object casts on another are not predicted.
    """
    tile = Tile.under_lights(capture.lights, capture.points, capture.to_camera)
    lost = np.zeros((1, 1, 1), bool) if capture.lost is None else capture.lost
    pairs = {}
    parts = zip(
        capture.names,
        capture.values,
        np.broadcast_to(lost, capture.values.shape),
        predict(tile, reflection, normals, weights),
        strict=True,
    )
    for name, values, is_lost, (predicted, faces) in parts:
        counts: AnyArray = faces & ~is_lost.any(axis=1) & (values.mean(axis=1) > 0)
        pairs[name] = predicted[counts].astype(np.float32), values[counts]
    return pairs
