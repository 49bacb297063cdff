"""Raises errors if the formula of a model or a loss, or a derivative, is not finite at a sample.

The error names the directions of the sample, so that a user can correct the formula. Without it, a
sum over all samples would hide the sample, and the search would fail with an unclear error.
"""

from collections.abc import Iterable, Mapping
from typing import Any, NoReturn

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_angles
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.blocks import Block
from brdfkit.regression.problem.columns import Columns
from brdfkit.regression.problem.parameter_space import Space

REMEDY = "keep the formula finite there, as by dr.maximum, or leave the direction out of the data"


def require_finite_columns(
    columns: Columns, values: FloatArray, block: Block, space: Space, u: FloatArray
) -> FloatArray:
    """Return the columns of a model at the samples of a block, all finite.

    `values`: the `columns` (points, columns, samples); `u` (points, shapes): coordinates of the
    points in the search `space`. Raises `BrdfkitError` if a value is not finite. A slope that is
    not finite becomes 0 if it is finite in Dr.Jit's reverse mode: forward mode returns NaN for the
    derivative of 0^p by p.
    """
    with np.errstate(invalid="ignore"):
        if np.isfinite(values.sum()):  # quicker than a check of each
            return values
    count = len(columns.lobes)
    for lobe, value in zip(columns.lobes, values.swapaxes(0, 1), strict=False):
        if not np.isfinite(value).all():
            row = np.argwhere(~np.isfinite(value))[0][1]
            _raise_for_lobe(
                columns.model,
                lobe,
                value[~np.isfinite(value)][0],
                describe_direction_pair(*block.get_sample_directions(), row),
            )
    for point in np.flatnonzero(~np.isfinite(values).all(axis=(1, 2))):
        shapes = space.to_named_values(u[point])
        require_finite_slopes(columns.model, shapes, space.names, *block.get_sample_directions())
    slopes = np.nan_to_num(values[:, count:], posinf=0, neginf=0)
    return np.concatenate([values[:, :count], slopes], axis=1)


def require_finite_loss(
    loss: Loss,
    block: Block,
    model: JitFloat,
    measured: JitFloat,
    difference: JitFloat,
    slope: JitFloat,
) -> None:
    """Raise `BrdfkitError` if the difference of a loss, or its derivative, is not finite.

    `model`, `measured`: values of the BRDF at the samples of the `block`; `difference`: the loss's
    difference between both; `slope`: its derivative with respect to the model's value; all are
    Dr.Jit arrays.
    """
    differences, slopes = np.array(difference), np.array(slope)
    rows = np.flatnonzero(~(np.isfinite(differences) & np.isfinite(slopes)))
    if not len(rows):
        return
    row = rows[0]
    verb = "is" if not np.isfinite(differences[row]) else "has the derivative"
    value = slopes[row] if np.isfinite(differences[row]) else differences[row]
    raise BrdfkitError(
        f"The loss {loss.name} {verb} {value:g} at "
        f"{describe_direction_pair(block.wi, block.wo, row)}, where the measured value is "
        f"{np.array(measured)[row]:.4g} and the model's "
        f"{np.array(model)[row]:.4g}; keep it finite for all of these, as by dr.maximum."
    )


def require_finite_lobes(model: Any, columns: FloatArray, wi: Vector, wo: Vector) -> None:
    """Raise `BrdfkitError` if a value of the lobes, `columns` (lobes, n), is not finite."""
    if np.isfinite(columns.sum(axis=1)).all():  # quicker than a check of each
        return
    lobe, row = np.argwhere(~np.isfinite(columns))[0]
    _raise_for_lobe(model, lobe, columns[lobe, row], describe_direction_pair(wi, wo, row))


def _raise_for_lobe(model: Any, lobe: int, value: float, pair: str) -> NoReturn:
    """Raise the error for a lobe with a `value` that is not finite; `pair`: directions as text."""
    raise BrdfkitError(
        f"{model.type_name()}: the lobe of {model.weights()[lobe]} is {value:g} at {pair}; "
        f"{REMEDY}."
    )


def require_finite_slopes(
    model: Any, values: Mapping[str, float], names: Iterable[str], wi: Vector, wo: Vector
) -> None:
    """Raise `BrdfkitError` if a lobe's derivative with respect to a shape parameter is not finite.

    `values`: values of all shape parameters by name; `names`: the parameters whose derivatives are
    checked; `wi`, `wo`: pairs of directions. Derivatives are taken in reverse mode, because
    Dr.Jit's forward mode returns NaN for the derivative of 0^p with respect to p, which is 0.
    """
    # Each pair of directions gets its own copy of a parameter, and so its own derivative
    count = len(wi.x)
    bound = {n: double_precision.to_array(np.full(count, v)) for n, v in values.items()}
    for name in names:
        dr.enable_grad(bound[name])
    made = model.bind(bound)
    lobes = [(f"the lobe of {weight}", lobe) for weight, lobe in made.terms()]
    lobes += [("a lobe without a weight", lobe) for lobe in made.fixed_lobes()]
    for what, evaluated in lobes:
        lobe = evaluated.eval(wi, wo)
        if not dr.grad_enabled(lobe):
            continue
        dr.clear_grad(bound)
        dr.backward(lobe, dr.ADFlag.ClearInterior)
        slopes = {name: dr.grad(bound[name]) for name in names}
        dr.eval(slopes)  # all of them in one kernel
        for name in names:
            slope = np.array(slopes[name])
            if not np.isfinite(slope).all():
                row = int(np.argmin(np.isfinite(slope)))
                raise BrdfkitError(
                    f"{model.type_name()}: the derivative by {name} of {what} is "
                    f"{slope[row]:g} at {describe_direction_pair(wi, wo, row)}; {REMEDY}."
                )


def describe_direction_pair(wi: Vector, wo: Vector, row: int) -> str:
    """Return one of the pairs of directions `wi`, `wo` as text, for an error message.

    `row`: index of the pair.
    """
    pair = [np.array([np.array(c)[row] for c in (w.x, w.y, w.z)]) for w in (wi, wo)]
    (theta_i, phi_i), (theta_o, phi_o) = map(to_angles, pair)
    angles = np.degrees([theta_i, theta_o, np.mod(phi_o - phi_i, 2 * np.pi)])
    h = pair[0] + pair[1]
    normal = ", where h is the normal" if np.hypot(h[0], h[1]) < 1e-7 * np.linalg.norm(h) else ""
    return "theta_i {:.4g}°, theta_o {:.4g}°, Δφ {:.4g}°".format(*angles) + normal
