"""Says where values were not measured: below a fit, and in a file that `convert` writes."""

import numpy as np
from numpy.typing import NDArray

from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import (
    PAIRS,
    compute_coverage,
    compute_coverage_at,
    find_largest_angles,
)

# A fit is told of more than this share of the direction pairs
SHARE = 0.1
# A converted file is told of more than this share, and of a maximum so many times the measured one
LEAST, RISE = 0.005, 1.05


def note_on_extrapolation(data: Measured, max_angle: float) -> list[str]:
    """The note, if any, on a fit to a `Measured` of which much below `max_angle` [degrees] lies
    beyond the measured angles."""
    if data.is_table:
        return []  # does not tell which cells were measured
    smaller, larger = find_largest_angles(data)
    inside = [1 - np.cos(np.radians(min(a, max_angle))) for a in (smaller, larger, max_angle)]
    # An upper limit first, which costs nothing: pairs within both angles, by solid angle
    if 1 - (inside[1] ** 2 - (inside[1] - inside[0]) ** 2) / inside[2] ** 2 <= SHARE:
        return []
    beyond = compute_coverage(data, max_angle).beyond
    if beyond <= SHARE:
        return []
    reach = " and ".join(dict.fromkeys(f"{angle:.0f}°" for angle in (smaller, larger)))
    return [
        f"{beyond:.0%} of the direction pairs below {max_angle:g}° lie beyond the measured angles, "
        f"which reach {reach}: there the fit extrapolates, and nothing tests it"
    ]


def describe_extrapolation(before: Measured, after: Measured) -> list[str]:
    """A sentence on how much of `after`, written of `before`, was not measured; none for nothing.

    Of a table it is the share of the direction pairs that `info` says of `before`, of samples the
    share of these.
    """
    if before.is_table or len(after.values) == len(before.values):
        return []
    pairs = () if after.is_table else _some_pairs(after)
    at = compute_coverage_at(before, *pairs) if pairs else compute_coverage(before)
    shares = {"extrapolated": at.beyond}
    if not before.has_lookup:  # else the format itself defines the values between
        shares["interpolated across gaps"] = at.between
    told = [f"{share:.0%} {what}" for what, share in shares.items() if share > LEAST]
    if not told:
        return []
    if before.channels != after.channels:
        before, after = before.rgb, after.rgb
    most, now = (float(data.values[data.samples.valid].max()) for data in (before, after))
    rise = f"; the maximum rises from {most:.4g} to {now:.4g} sr⁻¹" if now > RISE * most else ""
    share, _, what = " and ".join(told).partition(" ")
    unit = "the table is" if after.is_table else "the new samples are"
    return [f"{share} of {unit} {what}{rise}"]


def _some_pairs(data: Measured) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Some direction pairs (wi, wo) of a `Measured` that is no table."""
    (rows,) = np.nonzero(data.samples.valid)
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), PAIRS)).astype(int)]
    return data.samples.wi[rows], data.samples.wo[rows]
