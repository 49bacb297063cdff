"""Errors for a model whose formula, or a derivative of it, is not finite at some sample.

A sum over all samples would hide which one, and a search would go wrong or end in another library's
error.
"""

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_angles
from brdfkit.core.jit import double_precision

REMEDY = "keep the formula finite there, as by dr.maximum, or leave the direction out of the data"


def require_finite_columns(columns, values, block, space, u):
    """The arrays `values` (points, n) of the `Columns` at the samples of a `Block`, all finite.

    Raises `BrdfkitError` where one is not. Slopes that are finite backwards, as those of 0^p by p,
    become 0: forwards, Dr.Jit has NaN there. `u` (points, shapes): coordinates in the `space`.
    """
    if all(np.isfinite(value.sum()) for value in values):  # quick: one sum per column
        return values
    count = len(columns.lobes)
    for lobe, value in zip(columns.lobes, values, strict=False):
        if not np.isfinite(value).all():
            row = np.argwhere(~np.isfinite(value))[0][1]
            _raise_for_lobe(
                columns.model,
                lobe,
                value[~np.isfinite(value)][0],
                describe_pair(*block.first(), row),
            )
    for point in np.flatnonzero(
        [not np.isfinite([v[k] for v in values]).all() for k in range(len(u))]
    ):
        shapes = space.values(u[point])
        require_finite_slopes(columns.model, shapes, space.names, *block.first())
    return [*values[:count], *(np.nan_to_num(v, posinf=0, neginf=0) for v in values[count:])]


def require_finite_loss(loss, block, model, measured, difference, slope):
    """Raise `BrdfkitError` where the `difference` of a `Loss`, or its `slope`, is not finite at one
    of the samples of a `Block`; all arrays of Dr.Jit's."""
    found, by = np.array(difference), np.array(slope)
    rows = np.flatnonzero(~(np.isfinite(found) & np.isfinite(by)))
    if not len(rows):
        return
    row = rows[0]
    what = "is" if not np.isfinite(found[row]) else "has the derivative"
    value = by[row] if np.isfinite(found[row]) else found[row]
    raise BrdfkitError(
        f"The loss {loss.name} {what} {value:g} at {describe_pair(block.wi, block.wo, row)}, where "
        f"the measured value is {np.array(measured)[row]:.4g} and the model's "
        f"{np.array(model)[row]:.4g}; keep it finite for all of these, as by dr.maximum."
    )


def require_finite(model, columns, wi, wo):
    """Raise `BrdfkitError` where a lobe's values, `columns` (lobes, n), are not finite."""
    if np.isfinite(columns.sum(axis=1)).all():  # quick: one sum per lobe
        return
    lobe, row = np.argwhere(~np.isfinite(columns))[0]
    _raise_for_lobe(model, lobe, columns[lobe, row], describe_pair(wi, wo, row))


def _raise_for_lobe(model, lobe, value, pair):
    raise BrdfkitError(
        f"{model.type_name()}: the lobe of {model.weights()[lobe]} is {value:g} at {pair}; "
        f"{REMEDY}."
    )


def require_finite_slopes(model, values, names, wi, wo):
    """Raise `BrdfkitError` where a lobe's derivative by one of the parameters `names` is not
    finite, at `values` of the shape parameters; `wi`, `wo`: `double_precision.Vector`.

    The derivatives are taken in reverse mode: in forward mode Dr.Jit gives no finite derivative of
    0^p by p, which is 0.
    """
    # One value for each pair, so that its derivative is that of the pair, and no sum is taken
    count = len(wi.x)
    bound = {n: double_precision.to_array(np.full(count, v)) for n, v in values.items()}
    for name in names:
        dr.enable_grad(bound[name])
    lobes = [lobe.eval(wi, wo) for _, lobe in model.bind(bound).terms()]
    for weight, lobe in zip(model.weights(), lobes, strict=True):
        if not dr.grad_enabled(lobe):
            continue
        dr.clear_grad(bound)
        dr.backward(lobe, dr.ADFlag.ClearInterior)
        slopes = {name: dr.grad(bound[name]) for name in names}
        dr.eval(slopes)  # in one kernel
        for name, found in slopes.items():
            slope = np.array(found)
            if not np.isfinite(slope).all():
                row = int(np.argmin(np.isfinite(slope)))
                raise BrdfkitError(
                    f"{model.type_name()}: the derivative by {name} of the lobe of {weight} is "
                    f"{slope[row]:g} at {describe_pair(wi, wo, row)}; {REMEDY}."
                )


def describe_pair(wi, wo, row):
    """The direction pair number `row` in words; `wi`, `wo`: `double_precision.Vector`."""
    pair = [np.array([np.array(c)[row] for c in (w.x, w.y, w.z)]) for w in (wi, wo)]
    (theta_i, phi_i), (theta_o, phi_o) = map(to_angles, pair)
    apart = np.mod(phi_o - phi_i, 2 * np.pi)
    angles = np.degrees([theta_i, theta_o, apart])
    h = pair[0] + pair[1]
    normal = ", where h is the normal" if np.hypot(h[0], h[1]) < 1e-7 * np.linalg.norm(h) else ""
    return "theta_i {:.4g}°, theta_o {:.4g}°, Δφ {:.4g}°".format(*angles) + normal
