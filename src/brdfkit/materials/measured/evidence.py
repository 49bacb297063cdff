"""What a completed table knows: which of its values were measured, inferred or guessed, how surely.

`complete` gives such tables. Their standard errors are those of ln(f c + e), with the BRDF f, the
cosines c and an offset e below which values count as equal, times f + e/c.
"""

from __future__ import annotations

from collections.abc import Collection
from math import exp

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, IntArray
from brdfkit.core.names import make_unique
from brdfkit.materials.measured.measured_data import MeasuredData
from brdfkit.model.samples import Table

MEASURED, INFERRED, GUESSED = 0, 1, 2
NAMES = "measured", "inferred", "guessed"
LEAST_COSINE = 0.05  # the least c: towards the horizon, values grow but their light does not
OFFSET = 1e-3  # e [sr⁻¹]
NORMAL_95 = 1.96  # half-width of a 95 % interval [standard errors]
GRAZING = np.cos(np.radians(80.0))  # a direction with a smaller cosine is grazing
LEAST_PLACE = 0.01  # of places with a smaller share of all pairs of directions nothing is told
LARGEST_SHARE = 0.5  # larger errors of a logarithm are told as factors


def is_completed(data: MeasuredData) -> bool:
    """Return whether a material has evidence, or its file noted that it was completed."""
    return data.evidence is not None or data.info.get("completed", "").endswith("by a prior")


def make_name_unique(name: str, material: object, taken: Collection[str]) -> str:
    """Return the `name` of a material, or a name that is not `taken`.

    A completed material often stands beside that from which it was made, and is then called so.
    """
    completed = getattr(material, "evidence", None) is not None
    return make_unique(f"{name}, completed" if completed and name in taken else name, taken)


def find_evidence(data: MeasuredData, wi: AnyArray, wo: AnyArray) -> IntArray:
    """Return the evidence (n,) of the cells in which pairs of directions (n, 3) lie.

    `data` has evidence. Directions below the surface are guesses.
    """
    assert data.evidence is not None
    assert data._table is not None
    grid, found = data.evidence.reshape(data._table.shape), np.full(len(wi), GUESSED)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    found[above] = grid[data._table.find_cells(wi[above], wo[above])]
    return found


def find_measured_rows(data: MeasuredData) -> BoolArray:
    """Return a mask (n,) of the valid samples; in a completed table, of those that were measured.

    If the table has none that was measured, all valid ones count.
    """
    valid: BoolArray = data.samples.valid
    if data.evidence is None:
        return valid
    measured = valid & (data.evidence == MEASURED)
    return measured if measured.any() else valid


def compute_shares(data: MeasuredData) -> tuple[float, float, float]:
    """Return the shares of all pairs of directions that were measured, inferred and guessed."""
    assert data.evidence is not None
    assert data._table is not None
    low, _ = sort_cosines(data.samples.wi, data.samples.wo)
    weight = compute_solid_angles(data._table) * (low > 0)
    shares = [float(weight[data.evidence == kind].sum() / weight.sum()) for kind in range(3)]
    return shares[0], shares[1], shares[2]


def compute_deviation(values: AnyArray, errors: AnyArray, cosine: AnyArray) -> FloatArray:
    """Return the standard deviation of ln(f c + e) for BRDF values f and their standard errors."""
    result: FloatArray = errors / (
        np.maximum(values, 0) + OFFSET / np.maximum(cosine, LEAST_COSINE)
    )
    return result


def compute_interval(
    values: AnyArray, errors: AnyArray, cosine: AnyArray
) -> tuple[FloatArray, FloatArray]:
    """Return the ends of the 95 % intervals of BRDF values, at least 0."""
    factor = np.exp(NORMAL_95 * compute_deviation(values, errors, cosine))
    offset = OFFSET / np.maximum(cosine, LEAST_COSINE)
    return np.maximum((values + offset) / factor - offset, 0), (values + offset) * factor - offset


def evaluate_errors(data: MeasuredData, wi: AnyArray, wo: AnyArray) -> FloatArray:
    """Return the standard errors (n, channels) of a table, interpolated at pairs (n, 3)."""
    assert data.standard_error is not None
    assert data._table is not None
    grid = data.standard_error.reshape(data._table.values.shape)
    return Table(grid, data._table.phi_d_period).eval(wi, wo)


def compute_half_widths(data: MeasuredData) -> dict[str, float]:
    """Return typical half-widths of the 95 % intervals of ln f, by the place of the directions.

    "inside": both angles to the normal are within 5° of the measured ones; "outside": they are not,
    but below 80°; "at grazing angles": the larger one is above 80°. They are medians over pairs of
    directions, and places with hardly any pairs are left out.
    """
    samples, errors = data.samples, data.standard_error
    assert errors is not None
    low, high = sort_cosines(samples.wi, samples.wo)
    known = find_measured_rows(data)
    within = (low >= low[known].min()) & (high >= high[known].min())
    grazing = low < GRAZING
    cosine = (low * high)[:, None]
    widths = NORMAL_95 * compute_deviation(samples.values, errors, cosine).mean(axis=1)
    masks = {
        "inside": within & ~grazing,
        "outside": ~within & ~grazing,
        "at grazing angles": grazing,
    }
    assert data._table is not None
    pairs = compute_solid_angles(data._table) * (samples.valid & (low > 0))
    return {
        place: compute_weighted_median(widths[mask], pairs[mask])
        for place, mask in masks.items()
        if pairs[mask].sum() > LEAST_PLACE * pairs.sum()
    }


def describe_evidence(data: MeasuredData) -> dict[str, str]:
    """Return in words which shares of a completed table were measured, and how sure it is.

    The texts are in a dictionary by their headings, which is empty for any other material.
    """
    if data.evidence is None or data._table is None:
        return {}
    shares = zip(NAMES, compute_shares(data), strict=True)
    rows = {"evidence": ", ".join(f"{name} {100 * share:.3g} %" for name, share in shares)}
    if data.standard_error is not None:
        widths = compute_half_widths(data).items()
        words = ", ".join(f"{format_half_width(w)} {place}" for place, w in widths)
        rows["95 % intervals"] = f"{words} (medians)"
    return rows


def format_half_width(width: float) -> str:
    """Return the half-width of an interval of a logarithm in words.

    >>> format_half_width(0.12), format_half_width(1.1)
    ('±12 %', 'a factor of 3.0 each way')
    """
    text = format_logarithm(width)
    return f"±{text}" if width < LARGEST_SHARE else f"{text} each way"


def format_logarithm(error: float) -> str:
    """Return an error of a natural logarithm as a share, or as a factor if it is large.

    >>> format_logarithm(0.121), format_logarithm(1.76)
    ('12 %', 'a factor of 5.8')
    """
    return f"{100 * error:.2g} %" if error < LARGEST_SHARE else f"a factor of {exp(error):.1f}"


def sort_cosines(wi: AnyArray, wo: AnyArray) -> tuple[FloatArray, FloatArray]:
    """Return the smaller and the larger cosine to the normal of each pair (n, 3), both (n,)."""
    return np.minimum(wi[:, 2], wo[:, 2]), np.maximum(wi[:, 2], wo[:, 2])


def compute_weighted_median(values: FloatArray, weights: FloatArray) -> float:
    """Return the median of `values` (n,) with `weights` (n,), of which some are above 0."""
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])


def compute_solid_angles(table: Table) -> FloatArray:
    """Return the products of solid angles dωi dωo (cells,) of a table's cells, up to a factor.

    dωi dωo = 4 cos θd dωh dωd [Rusinkiewicz 1998].
    """
    size = table.extents[..., 1:]
    return np.broadcast_to(size, table.shape).reshape(-1)
