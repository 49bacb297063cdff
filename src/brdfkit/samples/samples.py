"""Samples of a BRDF: direction pairs with what was measured there."""

import math
from dataclasses import dataclass, fields

import numpy as np

from brdfkit.errors import BrdfkitError


@dataclass(frozen=True, eq=False)
class Samples:
    """Direction pairs with their BRDF.

    `wi`, `wo`: unit vectors (n, 3); `values`: (n, channels) in sr⁻¹, as measured, negative
    ones too; `valid`: (n,), False where the reader or the format says that nothing was measured;
    `weight`: (n,), how much each counts in a loss: 1 for a scattered sample, the width in
    theta_h for a table's cell, so that a table counts evenly over Rusinkiewicz's angles however
    finely it divides the highlight.
    """

    wi: np.ndarray
    wo: np.ndarray
    values: np.ndarray
    valid: np.ndarray
    weight: np.ndarray

    @classmethod
    def checked(cls, wi, wo, values, valid, channels, name):
        """Of any arrays: directions are normalised, and what cannot be is not `valid`.

        Values of one channel may be (n,). Raises `BrdfkitError` for arrays that do not belong
        together, and where nothing is left.
        """
        given = [np.array(a, float) for a in (wi, wo, values)]
        wi, wo, values = (np.atleast_2d(a) for a in given)
        if given[2].ndim == 1 and len(channels) == 1:
            values = given[2][:, None]
        if wi.shape != wo.shape or wi.shape[1:] != (3,) or values.shape != (len(wi), len(channels)):
            shapes = [a.shape for a in given]
            raise BrdfkitError(
                f"{name}: wi {shapes[0]} and wo {shapes[1]} should be (n, 3), values {shapes[2]} "
                f"should be (n, {len(channels)}) for the channels {', '.join(channels)}."
            )
        with np.errstate(invalid="ignore", divide="ignore"):
            wi, wo = (w / np.linalg.norm(w, axis=1, keepdims=True) for w in (wi, wo))
        seen = _seen(wi, wo, values)
        if valid is not None:
            seen &= _mask(valid, len(wi), name)
        require_some(seen, name)
        return cls(wi, wo, values, seen, np.ones(len(seen)))

    @classmethod
    def of_table(cls, table):
        """A table's cells, at their centres."""
        wi, wo = (w.reshape(-1, 3) for w in table.directions())
        values = table.values.reshape(len(wi), -1)
        weight = np.broadcast_to(table.theta_h_widths, table.shape).reshape(-1)
        return cls(wi, wo, values, _seen(wi, wo, values), weight)

    def within(self, max_angle):
        """Which are valid, with both angles below `max_angle` [degrees] (n,)."""
        cos_min = math.cos(math.radians(max_angle)) * (1 + 1e-12)
        return self.valid & (self.wi[:, 2] > cos_min) & (self.wo[:, 2] > cos_min)

    def at(self, rows):
        """These `rows` (mask or indices) only."""
        return Samples(*(getattr(self, f.name)[rows] for f in fields(self)))


def require_some(valid, name):
    """Raise `BrdfkitError` unless one is valid."""
    if not valid.any():
        raise BrdfkitError(
            f"{name}: no valid measurement is left (all masked, not finite or below the surface)."
        )


def _mask(valid, n, name):
    valid = np.asarray(valid, bool)
    if valid.shape != (n,):
        raise BrdfkitError(
            f"{name}: valid {valid.shape} should be ({n},), one for each of the samples."
        )
    return valid


def _seen(wi, wo, values):
    return np.isfinite(values).all(axis=1) & (wi[:, 2] > 0) & (wo[:, 2] > 0)
