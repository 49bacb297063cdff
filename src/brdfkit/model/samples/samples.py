"""Samples of a BRDF: direction pairs with the values measured there."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.model.samples.cells import copy_columns, find_directions_within, minimum_cosine


@dataclass(frozen=True, eq=False)
class Samples:
    """Direction pairs with the BRDF's values.

    `wi`, `wo`: unit vectors (n, 3); `values`: (n, channels) in sr⁻¹, as measured, negative ones
    included; `valid`: (n,), False where the reader or the format says that nothing was measured;
    `weight`: (n,), a factor of each sample in every loss, such as a user's weight; `extents`:
    (n, 2), how much of both measures of `measures.py` each sample stands for, or None where that is
    not known.
    `cells`: of a table's cells, the numbers (n,) of the half vector and of its pair with theta_d,
    each in order; else None. `errors`: the standard errors of the values (n, channels), where they
    are known and count.
    """

    wi: np.ndarray
    wo: np.ndarray
    values: np.ndarray
    valid: np.ndarray
    weight: np.ndarray
    extents: np.ndarray | None = None
    cells: tuple[np.ndarray, np.ndarray] | None = None
    errors: np.ndarray | None = None

    @classmethod
    def from_arrays(cls, wi, wo, values, valid, channels, name):
        """`Samples` of arrays as a user gives them.

        `wi`, `wo`: vectors (n, 3), normalised here; `values`: (n, channels), or (n,) of one
        channel; `valid`: (n,) or None. Samples that are not finite or have a direction below the
        surface become invalid. Raises `BrdfkitError` for shapes that do not fit, and where no
        sample is valid.
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
        usable = _find_usable(wi, wo, values)
        if valid is not None:
            usable &= _check_mask(valid, len(wi), name)
        require_valid(usable, name, values, channels)
        return cls(wi, wo, values, usable, np.ones(len(usable)))

    @classmethod
    def from_table(cls, table):
        """One sample per cell of a `Table`, at the cell's centre."""
        wi, wo = (w.reshape(-1, 3) for w in table.directions())
        values = table.values.reshape(len(wi), -1)
        return cls(wi, wo, values, _find_usable(wi, wo, values), np.ones(len(wi)))

    @classmethod
    def from_cells(cls, table, max_angle, factors=None, errors=None):
        """As `from_table`, of the known cells with both angles below `max_angle` [degrees].

        `factors`: of the weights, (cells,), and `errors` (cells, channels): of all cells, in C
        order.
        """
        axes = tuple(tuple(axis.tolist()) for axis in table.centres)
        cells, wi, wo = find_directions_within(axes, float(max_angle))
        values = table.values.reshape(-1, table.values.shape[-1])
        values = copy_columns(values, cells)
        known = np.isfinite(values).all(axis=1)
        n_h, n_d, n_p = table.shape[-3:]
        pairs = cells // n_p
        half_vectors = pairs // n_d
        weight = np.ones(len(cells)) if factors is None else factors[cells]
        extents = copy_columns(table.extents.reshape(-1, 2), pairs % (n_h * n_d))
        own = None if errors is None else errors[cells]
        samples = cls(wi, wo, values, known, weight, extents, (half_vectors, pairs), own)
        return samples if known.all() else samples.at(known)

    @property
    def largest_angle(self):
        """The largest angle to the normal of all directions [degrees]."""
        return float(np.degrees(np.arccos(min(self.wi[:, 2].min(), self.wo[:, 2].min(), 1.0))))

    def within(self, max_angle):
        """A mask (n,) of the valid samples with θ_i and θ_o below `max_angle` [degrees]."""
        cos_min = minimum_cosine(max_angle)
        return self.valid & (self.wi[:, 2] > cos_min) & (self.wo[:, 2] > cos_min)

    def at(self, rows):
        """The `Samples` of these `rows` (a mask or indices)."""
        vectors = (copy_columns(a, rows) for a in (self.wi, self.wo, self.values))
        cells = self.cells and tuple(numbers[rows] for numbers in self.cells)
        extents, errors = (None if of is None else of[rows] for of in (self.extents, self.errors))
        return Samples(*vectors, self.valid[rows], self.weight[rows], extents, cells, errors)


def require_valid(valid, name, values, channels):
    """Raise `BrdfkitError` where no sample is valid, by the mask `valid` (...); it names the
    `channels` that have no finite one among the `values` (..., channels)."""
    if not valid.any():
        known = np.isfinite(values).reshape(-1, len(channels)).any(axis=0)
        blank = [channel for channel, has in zip(channels, known, strict=True) if not has]
        if 0 < len(blank) < len(channels):
            raise BrdfkitError(
                f"{name}: no value of the channel {', '.join(blank)} is finite; give the other "
                "channels alone."
            )
        raise BrdfkitError(
            f"{name}: no valid measurement is left (all masked, not finite or below the surface)."
        )


def _check_mask(valid, n, name):
    valid = np.asarray(valid, bool)
    if valid.shape != (n,):
        raise BrdfkitError(
            f"{name}: valid {valid.shape} should be ({n},), one for each of the samples."
        )
    return valid


def _find_usable(wi, wo, values):
    """A mask (n,) of the samples with finite values and both directions above the surface."""
    return np.isfinite(values).all(axis=1) & (wi[:, 2] > 0) & (wo[:, 2] > 0)
