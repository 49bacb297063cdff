"""Draws a random part of a large measurement, so that statistics are computed in milliseconds."""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.geometry.directions import from_half_difference
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples, Table

MOST_SAMPLES = 50_000  # largest number of samples, or cells, that are drawn
MOST_CELLS = 200_000  # largest number of cells of a table, approximately, that are compared


def draw_row_numbers(count: int) -> IntArray:
    """Draw the numbers of at most 50,000 of `count` rows, ascending, the same ones in each call."""
    if count <= MOST_SAMPLES:
        return np.arange(count)
    return np.unique(np.random.default_rng(0).integers(count, size=MOST_SAMPLES))


def draw_samples(data: Measured) -> Samples:
    """Draw at most 50,000 samples of a `Measured`; cells of a table are converted to samples."""
    if not data.is_table:
        samples, count = data.samples, len(data.samples.wi)
        return samples if count <= MOST_SAMPLES else samples.at(draw_row_numbers(count))
    table = data.table
    cells = draw_row_numbers(table.values[..., 0].size)
    places = np.unravel_index(cells, table.shape)
    *phi_h, theta_h, theta_d, phi_d = map(np.take, table.centres, places)
    wi, wo = from_half_difference(theta_h, theta_d, phi_d, *phi_h)
    values = table.values.reshape(-1, table.values.shape[-1])[cells]
    known = np.isfinite(values).all(axis=1) & (wi[:, 2] > 0) & (wo[:, 2] > 0)
    return Samples(wi, wo, values, known, np.ones(len(cells)))


def draw_valid_samples(data: Measured) -> Samples:
    """Draw at most 50,000 samples of a `Measured`, and return the valid ones among them."""
    samples = draw_samples(data)
    return samples.at(samples.valid)


def thin_out_theta_h(table: Table) -> FloatArray:
    """Return a table's values; of a large table, only every few theta_h, to save time."""
    step = -(-table.values[..., 0].size // MOST_CELLS)
    return table.values[..., ::step, :, :, :]
