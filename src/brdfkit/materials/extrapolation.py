"""Notes on values that were not measured, for a fit and for a file that `convert` writes."""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import (
    PAIRS,
    compute_coverage,
    compute_coverage_at,
    find_largest_angles,
)

LARGEST_FIT_SHARE = 0.1  # of the direction pairs: a fit with more gets a note
# A converted file gets a note for more than this share, and for a maximum that rises by more
LARGEST_FILE_SHARE, LARGEST_RISE = 0.005, 1.05


def note_extrapolation(data: Measured, max_angle: float) -> list[str]:
    """Return a note on a fit to a `Measured` that extrapolates much, or no note.

    The share of direction pairs below `max_angle` [degrees] and beyond the measured angles counts.
    """
    if data.is_table:
        return []  # a table does not say which cells were measured
    smaller, larger = find_largest_angles(data)
    inside = [1 - np.cos(np.radians(min(a, max_angle))) for a in (smaller, larger, max_angle)]
    # An upper limit first, which costs nothing: pairs within both angles, by solid angle
    if 1 - (inside[1] ** 2 - (inside[1] - inside[0]) ** 2) / inside[2] ** 2 <= LARGEST_FIT_SHARE:
        return []
    beyond = compute_coverage(data, max_angle).beyond
    if beyond <= LARGEST_FIT_SHARE:
        return []
    reach = " and ".join(dict.fromkeys(f"{angle:.0f}°" for angle in (smaller, larger)))
    return [
        f"{beyond:.0%} of the direction pairs below {max_angle:g}° lie beyond the measured angles, "
        f"which reach {reach}: there the fit extrapolates, and nothing tests it"
    ]


def describe_extrapolation(before: Measured, after: Measured) -> list[str]:
    """Return a sentence on how much of `after`, a file of `before`, was not measured, or none.

    For a table it is a share of the direction pairs, and for samples a share of the samples.
    """
    if before.is_table or len(after.values) == len(before.values):
        return []
    pairs = () if after.is_table else _pick_pairs(after)
    at = compute_coverage_at(before, *pairs) if pairs else compute_coverage(before)
    shares = {"extrapolated": at.beyond}
    if not before.has_lookup:  # else the format itself defines the values between
        shares["interpolated across gaps"] = at.between
    phrases = [
        f"{share:.0%} {what}" for what, share in shares.items() if share > LARGEST_FILE_SHARE
    ]
    if not phrases:
        return []
    if before.channels != after.channels:
        before, after = before.rgb, after.rgb
    old, new = (float(data.values[data.samples.valid].max()) for data in (before, after))
    rises = new > LARGEST_RISE * old
    rise = f"; the maximum rises from {old:.4g} to {new:.4g} sr⁻¹" if rises else ""
    share, _, what = " and ".join(phrases).partition(" ")
    unit = "the table is" if after.is_table else "the new samples are"
    return [f"{share} of {unit} {what}{rise}"]


def _pick_pairs(data: Measured) -> tuple[FloatArray, FloatArray]:
    """Return at most `PAIRS` direction pairs (n, 3) of a `Measured` with scattered samples."""
    (rows,) = np.nonzero(data.samples.valid)
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), PAIRS)).astype(int)]
    return data.samples.wi[rows], data.samples.wo[rows]
