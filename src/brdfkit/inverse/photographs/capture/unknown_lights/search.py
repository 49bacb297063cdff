"""Searches the matrix that makes lights and normals of the factors of photographs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.unknown_lights.clues import Clues
from brdfkit.inverse.photographs.capture.unknown_lights.factors import Factors, equalise_albedos

ROUNDS = 30  # of fits of a rotation to the outline
START_ANGLES = 30.0, 60.0  # degrees by which the first rotation is also turned to start from
STARTS = 4  # the best of them, from which a search starts
STEPS = {"rotation": 0.15, "all": 0.1}  # first steps of the searches
LIMITS = {"rotation": 150, "all": 1500}  # most steps of them


def find_matrix(factors: Factors) -> FloatArray:
    """Return the matrix A (3, 3) with which A b are scaled normals, and L A⁻¹ lights.

    It is C of `equalise_albedos`, then the rotation that turns normals at the outline outwards,
    then the best of its neighbours by all clues.
    """
    clues = Clues.collect(factors)
    first = rotate_to_outline(equalise_albedos(factors.normals[factors.lit]), clues)
    turns = [np.zeros(3)]
    turns += [
        np.radians(angle) * sign * axis
        for angle in START_ANGLES
        for axis in np.eye(3)
        for sign in (1, -1)
    ]
    turns.sort(key=lambda turn: clues.measure_shape(_turn(turn) @ first))
    found = [
        _minimise(lambda x: clues.measure_shape(_turn(x) @ first), turn, "rotation")
        for turn in turns[:STARTS]
    ]
    results = []
    for turn, _ in found:
        turned = _turn(turn) @ first
        x, value = _minimise(partial(_measure_deformed, clues, turned), np.zeros(8), "all")
        results.append((value, _deform(x) @ turned))
    return min(results, key=lambda result: result[0])[1]


def _measure_deformed(clues: Clues, matrix: FloatArray, x: FloatArray) -> float:
    """Return how little a matrix (3, 3), deformed by eight numbers, suits all clues."""
    return clues.measure_all(_deform(x) @ matrix)


def rotate_to_outline(matrix: FloatArray, clues: Clues) -> FloatArray:
    """Return a matrix (3, 3) after the rotation that turns normals at the outline outwards.

    The rotation, which may also mirror, is the one of [Wahba 1965], with weights that let pixels
    of other directions count less. Normals of the inner pixels point to the camera.
    """
    normals = clues.outer @ matrix.T
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    outward = np.column_stack([clues.outward, np.zeros(len(clues.outward))])
    inner = (clues.inner @ matrix.T).mean(axis=0)
    weights, rotation = np.ones(len(outward)), np.eye(3)
    for _ in range(ROUNDS):
        u, _, v = np.linalg.svd((outward * weights[:, None]).T @ normals)
        options = [u @ np.diag([1, 1, sign]) @ v for sign in (1.0, -1.0)]
        rotation = max(options, key=lambda option: float((option @ inner)[2]))
        away = np.linalg.norm(normals @ rotation.T - outward, axis=1)
        weights = 1 / (1 + (away / max(1.48 * float(np.median(away)), 1e-6)) ** 2)
    turned: FloatArray = rotation @ matrix
    return turned


def _turn(vector: FloatArray) -> FloatArray:
    """Return the matrix (3, 3) of a rotation vector (3,)."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def _deform(x: FloatArray) -> FloatArray:
    """Return the matrix (3, 3) of a rotation of three numbers, then a stretch of five."""
    stretch = np.array([[x[0], x[1], x[2]], [0, x[3], x[4]], [0, 0, -x[0] - x[3]]])
    return (np.eye(3) + stretch) @ _turn(x[5:])


def _minimise(
    function: Callable[[FloatArray], float], start: FloatArray, what: str
) -> tuple[FloatArray, float]:
    """Return where a function is smallest near `start`, and its value, by Nelder and Mead."""
    simplex = np.vstack([start, start + STEPS[what] * np.eye(len(start))])
    options = {
        "initial_simplex": simplex,
        "maxiter": LIMITS[what],
        "xatol": 1e-3,
        "fatol": 1e-4,
    }
    result = minimize(function, start, method="Nelder-Mead", options=options)
    return np.asarray(result.x), float(result.fun)
