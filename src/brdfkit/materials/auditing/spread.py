"""A part of a large measurement, by which medians are found in milliseconds."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import from_half_difference
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples, Table

LARGEST = 50_000  # samples, or cells, that are looked at
LARGEST_SLICE = 200_000  # cells of a table that are compared with each other


def some_rows(count: int) -> NDArray[np.intp]:
    """The numbers of at most `LARGEST` of `count` rows, ascending; the same ones each time."""
    if count <= LARGEST:
        return np.arange(count)
    return np.unique(np.random.default_rng(0).integers(count, size=LARGEST))


def some_samples(data: Measured) -> Samples:
    """The samples of a `Measured`, or some of them; of a table, cells."""
    if not data.is_table:
        samples = data.samples
        return samples if len(samples.wi) <= LARGEST else samples.at(some_rows(len(samples.wi)))
    table = data.table
    cells = some_rows(table.values[..., 0].size)
    places = np.unravel_index(cells, table.shape)
    *phi_h, theta_h, theta_d, phi_d = map(np.take, table.centres, places)
    wi, wo = from_half_difference(theta_h, theta_d, phi_d, *phi_h)
    values = table.values.reshape(-1, table.values.shape[-1])[cells]
    known = np.isfinite(values).all(axis=1) & (wi[:, 2] > 0) & (wo[:, 2] > 0)
    return Samples(wi, wo, values, known, np.ones(len(cells)))


def some_valid(data: Measured) -> Samples:
    """Those of `some_samples` that are valid."""
    samples = some_samples(data)
    return samples.at(samples.valid)


def some_half_vectors(table: Table) -> NDArray[Any]:
    """The values of a `Table` at all theta_h, or of a large one at every few of them."""
    step = -(-table.values[..., 0].size // LARGEST_SLICE)
    return table.values[..., ::step, :, :, :]
