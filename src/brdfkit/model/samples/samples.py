"""Samples of a BRDF: pairs of directions with the values that were measured there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, BoolArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.model.samples.cells import copy_columns, find_cells_within, minimum_cosine
from brdfkit.model.samples.table import Table


@dataclass(frozen=True, eq=False)
class Samples:
    """Pairs of directions with the measured values of a BRDF.

    `wi` and `wo`: unit vectors (n, 3).
    `values`: measured values (n, channels) in sr⁻¹, which may be negative.
    `valid`: mask (n,), False where nothing was measured.
    `weight`: factor (n,) of each sample in every loss, such as a user's weight.
    `extents`: amounts (n, 2) of angles and of solid angle that each sample represents, by the two
    measures of `measures.py`, or None if unknown.
    `cells`: for samples of a table, two arrays (n,) of indices, in increasing order: of the cell of
    the half vector, and of the cell of half vector and theta_d; otherwise None.
    `errors`: standard errors (n, channels) of the values, or None if a fit should not use any.
    """

    wi: AnyArray
    wo: AnyArray
    values: AnyArray
    valid: AnyArray
    weight: AnyArray
    extents: AnyArray | None = None
    cells: tuple[AnyArray, ...] | None = None
    errors: AnyArray | None = None

    @classmethod
    def from_arrays(
        cls,
        wi: ArrayLike,
        wo: ArrayLike,
        values: ArrayLike,
        valid: ArrayLike | None,
        channels: Sequence[str],
        name: str,
    ) -> Samples:
        """Make samples from a user's arrays, normalising the directions `wi` and `wo` (n, 3).

        `values` are (n, channels), or (n,) for one channel; `valid` is (n,) or None. Samples that
        are not finite or have a direction below the surface become invalid. Raises `BrdfkitError`
        for wrong shapes, and if no sample is valid; `name` is the material's name in its message.
        """
        given = [np.array(a, float) for a in (wi, wo, values)]
        w_i, w_o, f = (np.atleast_2d(a) for a in given)
        if given[2].ndim == 1 and len(channels) == 1:
            f = given[2][:, None]
        if w_i.shape != w_o.shape or w_i.shape[1:] != (3,) or f.shape != (len(w_i), len(channels)):
            shapes = [a.shape for a in given]
            raise BrdfkitError(
                f"{name}: wi {shapes[0]} and wo {shapes[1]} should be (n, 3), values {shapes[2]} "
                f"should be (n, {len(channels)}) for the channels {', '.join(channels)}."
            )
        with np.errstate(invalid="ignore", divide="ignore"):
            w_i, w_o = (w / np.linalg.norm(w, axis=1, keepdims=True) for w in (w_i, w_o))
        usable = _find_usable(w_i, w_o, f)
        if valid is not None:
            mask = np.asarray(valid, bool)
            if mask.shape != usable.shape:
                raise BrdfkitError(
                    f"{name}: the shape of valid, {mask.shape}, should be {usable.shape}: one "
                    "entry per sample."
                )
            usable &= mask
        require_valid(usable, name, f, channels)
        return cls(w_i, w_o, f, usable, np.ones(len(usable)))

    @classmethod
    def from_table(cls, table: Table) -> Samples:
        """Make one sample for every cell of a table, at the cell's centre."""
        wi, wo = (w.reshape(-1, 3) for w in table.directions())
        values = table.values.reshape(len(wi), -1)
        return cls(wi, wo, values, _find_usable(wi, wo, values), np.ones(len(wi)))

    @classmethod
    def from_cells(
        cls,
        table: Table,
        max_angle: float,
        factors: AnyArray | None = None,
        errors: AnyArray | None = None,
    ) -> Samples:
        """Make samples of a table's known cells within `max_angle` [degrees] of the normal.

        `factors` (cells,) become the weights of the samples, and `errors` (cells, channels) their
        standard errors; both are given for all cells of the table, in C order.
        """
        cells = find_cells_within(table.shape, float(table.phi_d_period), float(max_angle))
        values = table.values.reshape(-1, table.values.shape[-1])
        values = copy_columns(values, cells.numbers)
        known = np.asarray(np.isfinite(values).all(axis=1))
        weight = np.ones(len(known)) if factors is None else factors[cells.numbers]
        own = None if errors is None else errors[cells.numbers]
        indices = cells.half_vectors, cells.pairs
        samples = cls(cells.wi, cells.wo, values, known, weight, cells.extents, indices, own)
        return samples if known.all() else samples.at(known)

    @cached_property
    def half_vector_starts(self) -> IntArray | None:
        """The index of the first sample of each half vector of a table, or None without a table."""
        if self.cells is None:
            return None
        return np.flatnonzero(np.diff(self.cells[0], prepend=-1))

    @property
    def largest_angle(self) -> float:
        """The largest angle [degrees] between the normal and a direction of the samples."""
        return float(np.degrees(np.arccos(min(self.wi[:, 2].min(), self.wo[:, 2].min(), 1.0))))

    def within(self, max_angle: float) -> BoolArray:
        """Return a mask (n,) of valid samples within `max_angle` [degrees] of the normal."""
        cos_min = minimum_cosine(max_angle)
        return self.valid & (self.wi[:, 2] > cos_min) & (self.wo[:, 2] > cos_min)

    def at(self, rows: Any) -> Samples:
        """Return only the samples of the given `rows`, a mask (n,) or indices."""
        wi, wo, values = (copy_columns(a, rows) for a in (self.wi, self.wo, self.values))
        cells = self.cells and tuple(numbers[rows] for numbers in self.cells)
        extents, errors = (a if a is None else a[rows] for a in (self.extents, self.errors))
        return Samples(wi, wo, values, self.valid[rows], self.weight[rows], extents, cells, errors)


def require_valid(valid: AnyArray, name: str, values: AnyArray, channels: Sequence[str]) -> None:
    """Raise `BrdfkitError` if the mask `valid` (...) of the material `name` is False everywhere.

    The message names the `channels` that have no finite value among `values` (..., channels).
    """
    if not valid.any():
        known = np.isfinite(values).reshape(-1, len(channels))
        blank = [channel for channel, has in zip(channels, known.T, strict=True) if not has.any()]
        if 0 < len(blank) < len(channels):
            raise BrdfkitError(
                f"{name}: no value of the channel {', '.join(blank)} is finite; give the other "
                "channels alone."
            )
        raise BrdfkitError(
            f"{name}: no valid measurement is left (all masked, not finite or below the surface)."
        )


def _find_usable(wi: AnyArray, wo: AnyArray, values: AnyArray) -> BoolArray:
    """Return a mask (n,) of the samples with finite values and directions above the surface."""
    return np.isfinite(values).all(axis=1) & (wi[:, 2] > 0) & (wo[:, 2] > 0)
