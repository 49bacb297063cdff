"""Warns in words where a fit, or a file that `convert` writes, goes beyond what was measured."""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import (
    PAIRS,
    compute_coverage,
    compute_coverage_at,
    find_largest_angles,
)

# A fit gets a note if more than this share of the pairs of directions lies beyond the measured
# angles
LARGEST_FIT_SHARE = 0.1
# A converted file gets a note if more than LARGEST_FILE_SHARE of its values were not measured. The
# note states the file's largest value if it exceeds the largest measured one by this factor
LARGEST_FILE_SHARE, LARGEST_RISE = 0.005, 1.05


def note_fit_extrapolation(data: Measured, max_angle: float) -> list[str]:
    """Return a list with a sentence on a fit that extrapolates much, or an empty list.

    A fit extrapolates where both angles to the normal are below its `max_angle` [degrees], but
    beyond the angles at which `data` was measured.
    """
    beyond = compute_share_beyond(data, max_angle)
    if beyond <= LARGEST_FIT_SHARE:
        return []
    return [
        f"{beyond:.0%} of the direction pairs below {max_angle:g}° lie beyond the measured angles, "
        f"which reach {describe_reach(data)}: there the fit extrapolates, and nothing tests it"
    ]


def compute_share_beyond(data: Measured, max_angle: float) -> float:
    """Return the share of direction pairs below `max_angle` [degrees] beyond the measured angles.

    It is 0 for a table, which does not say which of its cells were measured, and where a cheap
    bound shows that it is at most `LARGEST_FIT_SHARE`.
    """
    if data.is_table:
        return 0.0
    known = data.share_beyond_by_angle
    if max_angle not in known:
        known[max_angle] = _integrate_share_beyond(data, max_angle)
    return known[max_angle]


def _integrate_share_beyond(data: Measured, max_angle: float) -> float:
    """Return the share of `compute_share_beyond` for scattered samples."""
    smaller, larger = find_largest_angles(data)
    inside = [1 - np.cos(np.radians(min(a, max_angle))) for a in (smaller, larger, max_angle)]
    # Pairs of directions are within the measured angles if one is within the `smaller` angle, and
    # the other within the `larger` one
    if 1 - (inside[1] ** 2 - (inside[1] - inside[0]) ** 2) / inside[2] ** 2 <= LARGEST_FIT_SHARE:
        return 0.0
    return compute_coverage(data, max_angle).beyond


def describe_reach(data: Measured) -> str:
    """Return the largest measured angles to the normal in words, as "60° and 75°"."""
    return " and ".join(dict.fromkeys(f"{angle:.0f}°" for angle in find_largest_angles(data)))


def describe_file_extrapolation(before: Measured, after: Measured) -> list[str]:
    """Return a list with a sentence on how much of a file was not measured, or an empty list.

    `before` is the measurement, `after` the content of the file to which it was converted. The
    sentence states a share of all pairs of directions if the file holds a table, otherwise a share
    of its samples.
    """
    if before.is_table or len(after.values) == len(before.values):
        return []
    pairs = () if after.is_table else _pick_direction_pairs(after)
    at = compute_coverage_at(before, *pairs) if pairs else compute_coverage(before)
    shares = {"extrapolated": at.beyond}
    if not before.has_lookup:  # the file format does not define the values between the samples
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


def _pick_direction_pairs(data: Measured) -> tuple[FloatArray, FloatArray]:
    """Pick at most `PAIRS` of the valid samples evenly, and return their wi and wo (n, 3)."""
    (rows,) = np.nonzero(data.samples.valid)
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), PAIRS)).astype(int)]
    return data.samples.wi[rows], data.samples.wo[rows]
