"""Radiance: a BSDF file of tensor trees, for the primitive `BSDF` of its scenes.

Y of a colour is the tree "Visible", and u′ and v′ of CIE 1976 are two more. Radiance's primaries
take the place of those of sRGB, so that its programs show R, G and B of the fit.
"""

from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.exporting.filling import write_template
from brdfkit.exporting.loss import measure_log_error
from brdfkit.exporting.target import TABLE, Held, Target
from brdfkit.exporting.tensor_tree import (
    TensorTree,
    format_tree,
    merge_cells,
    round_digits,
    tabulate,
)
from brdfkit.materials.formats.rgl.encoding import detect_symmetry
from brdfkit.model import Model

# Depths of the trees that are tried until the log error is below the limit
DEPTHS, LARGEST_ERROR = (5, 6, 7), 0.05
ANISOTROPIC_DEPTH = 5  # one more would need 100 MB
TOLERANCE = 0.04  # the largest difference of values in a leaf, as a share of their mean
COLOUR_TOLERANCE = 0.01  # the same of u′ and v′
# Where all cells of a colour are brighter, Radiance takes the least off, as a diffuse part of wrong
# hue. One cell, at grazing angles, gets this value
DARK = 0.003
# Chromaticities (x, y, z) of Radiance's primaries, whose sum is its white, (⅓, ⅓, ⅓)
PRIMARIES = np.array([[0.64, 0.33, 0.03], [0.29, 0.6, 0.11], [0.15, 0.06, 0.79]])
TO_XYZ = (PRIMARIES.T * np.linalg.solve(PRIMARIES.T, np.ones(3))).T  # multiplies rows from the left
# The name of each tree, and of its detector
TREES = {"Visible": "ASTM E308 1931 Y.dsp", "CIE-u": "None", "CIE-v": "None"}


def hold(model: Model) -> Held:
    """Return the cells of the model's trees."""
    isotropic = detect_symmetry(model.eval) == 0
    for depth in DEPTHS if isotropic else (ANISOTROPIC_DEPTH,):
        trees = _make_trees(tabulate(model.eval, depth, isotropic))
        drawn = TensorTree(f"tree of {model.label()}", _to_rgb(trees))
        if measure_log_error(model, drawn) < LARGEST_ERROR:
            break
    cells = " × ".join([str(2**depth)] * (drawn.cells.ndim - 1))
    return Held(drawn, trees, (f"constant in each of {cells} cells",))


def _make_trees(cells: FloatArray) -> FloatArray:
    """Return Y and, unless all is grey, u′ and v′ (..., 3 or 1), of cells (..., channels)."""
    xyz = np.broadcast_to(cells, (*cells.shape[:-1], 3)) @ TO_XYZ
    Y = round_digits(merge_cells(xyz[..., 1], TOLERANCE))
    if np.allclose(cells, cells[..., :1], rtol=1e-4):
        return Y[..., None]
    corner = (0,) * Y.ndim
    Y[corner] = min(Y[corner], DARK)
    xyz = np.where(Y[..., None] > 0, xyz, 1.0)
    sums = xyz @ (1, 15, 3)
    colours = (factor * xyz[..., axis] / sums for factor, axis in ((4, 0), (9, 1)))
    return np.stack([Y, *(round_digits(merge_cells(c, COLOUR_TOLERANCE)) for c in colours)], -1)


def _to_rgb(trees: FloatArray) -> FloatArray:
    """Return R, G and B (..., 3) of the trees' values, as Radiance computes them."""
    if trees.shape[-1] == 1:
        return trees.repeat(3, axis=-1)
    Y, u, v = np.moveaxis(trees, -1, 0)
    xyz = np.stack([9 * u, 4 * v, 12 - 3 * u - 20 * v], axis=-1) * (Y / (4 * v))[..., None]
    return np.maximum(xyz @ np.linalg.inv(TO_XYZ), 0)


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the trees, and above them the primitive for a scene."""
    file = f'"{path.name}"' if " " in path.name else path.name
    usage = f"In a scene, the up vector being y: void BSDF material 6 0 {file} 0 1 0 . 0 0"
    values = np.moveaxis(held.content, -1, 0)
    write_template(
        "radiance.xml.jinja",
        path,
        comment=[*comment, usage],
        name=path.stem,
        rank=values.ndim - 1,
        trees=list(zip(TREES.items(), map(format_tree, values), strict=False)),
    )
    return [path]


TARGET = Target(
    name="radiance",
    title="Radiance: tensor trees",
    suffix=".xml",
    ending="_radiance",
    holds=TABLE,
    hold=hold,
    write=write,
    any_form=True,
)
