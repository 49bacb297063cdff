"""Finds the measured samples that are selected in the plots, with their numbers.

A selection is a tuple of ranges (name, low, high), all of which a pair of directions has to be in.
Names are those of `COORDINATES`, and "value", the measured value in the channel that is shown.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import to_angles, to_half_difference
from brdfkit.materials.measured import Measured
from brdfkit.viewing.materials.curves import Curve
from brdfkit.viewing.materials.plots.measured_points import wrap
from brdfkit.viewing.materials.plots.polar import make_views
from brdfkit.viewing.materials.plots.settings import PlotSettings

# Angles of a pair of directions [degrees]. "view" is θo, negative on the light's side; "plane" is
# the angle between the plane of the view and that of the light, 0 to 180
COORDINATES = "theta_i", "theta_o", "theta_h", "theta_d", "view", "plane", "phi_i"
LARGEST_SAMPLE = 2000  # pairs at which models are evaluated
LARGEST_MARKS = 60  # pairs that are marked in the plots
LARGEST_LIST = 30  # pairs whose numbers are listed, those with the largest ratios
LEAST_RATIO = 1e-3  # smallest value in a ratio, over the largest selected one


def compute_coordinates(wi: FloatArray, wo: FloatArray) -> dict[str, FloatArray]:
    """Return the `COORDINATES` (n,) of pairs of directions (n, 3), by name."""
    theta_h, theta_d, _ = (np.degrees(a) for a in to_half_difference(wi, wo))
    (theta_i, phi_i), (theta_o, phi_o) = ([np.degrees(a) for a in to_angles(w)] for w in (wi, wo))
    azimuth = wrap(phi_o - phi_i - 180)
    ahead = np.abs(azimuth) <= 90
    plane = np.where(ahead, np.abs(azimuth), 180 - np.abs(azimuth))
    # Within the plane of incidence 0 and 180 are the same; mirrored planes have the same number
    named = {"theta_i": theta_i, "theta_o": theta_o, "theta_h": theta_h, "theta_d": theta_d}
    return named | {"view": np.where(ahead, theta_o, -theta_o), "plane": plane, "phi_i": phi_i}


def find_within(
    selection: tuple[tuple[str, float, float], ...],
    coordinates: dict[str, FloatArray],
) -> BoolArray:
    """Return the mask (n,) of pairs whose coordinates are within all ranges of a selection."""
    inside: BoolArray = np.ones(len(coordinates["theta_i"]), bool)
    for name, low, high in selection:
        inside &= (coordinates[name] >= low) & (coordinates[name] <= high)
    return inside


def select_pairs(material: Any, settings: PlotSettings) -> dict[str, Any]:
    """Return the selected samples of a measurement: "wi", "wo" (n, 3), "values" (n, channels).

    At most `LARGEST_SAMPLE` of them, evenly chosen; "count" tells how many there are. Of a model,
    nothing.
    """
    if not isinstance(material, Measured):
        return {}
    samples = material.samples
    rows = np.flatnonzero(samples.valid)
    coordinates = compute_coordinates(samples.wi[rows], samples.wo[rows])
    coordinates["value"] = settings.pick_one(samples.values[rows])
    rows = rows[find_within(settings.selection, coordinates)]
    shown = rows[:: -(-len(rows) // LARGEST_SAMPLE) or 1]
    return {
        "count": len(rows),
        "wi": samples.wi[shown],
        "wo": samples.wo[shown],
        "values": samples.values[shown],
    }


def arrange_selection(
    curves: list[tuple[Curve, dict[str, Any]]], settings: PlotSettings
) -> dict[str, Any]:
    """Return the selected pairs: their marks, the medians of all materials, and the worst pairs.

    Where no sample lies, the views of the polar plot are taken, and interpolated values.
    """
    none: dict[str, Any] = {"count": 0}
    found = next((own for curve, own in curves if curve.is_measured), none)
    count, names = found["count"], [curve.name for curve, _ in curves]
    if count:
        wi, wo = found["wi"], found["wo"]
        values = [
            found["values"] if curve.is_measured else curve.material.eval(wi, wo)
            for curve, _ in curves
        ]
    else:
        _, wi, wo = make_views(settings)
        ranges = tuple(r for r in settings.selection if r[0] != "value")
        inside = find_within(ranges, compute_coordinates(wi, wo))
        wi, wo = wi[inside], wo[inside]
        values = [curve.material.eval(wi, wo) for curve, _ in curves]
    coordinates = compute_coordinates(wi, wo)
    colours = [np.broadcast_to(own, (len(wi), 3)) for own in values]
    shown = [settings.pick_one(own) for own in values]
    least = LEAST_RATIO * max((float(own.max()) for own in shown if own.size), default=1.0)
    ratios = [np.maximum(own, least) / np.maximum(shown[0], least) for own in shown]
    model = ratios[min(1, len(ratios) - 1)]  # that is shown; pins follow
    worst = np.argsort(-np.abs(np.log(model)), kind="stable")[:LARGEST_LIST]
    marked = np.arange(len(wi))[:: -(-len(wi) // LARGEST_MARKS) or 1]
    return {
        "count": count,
        "medians": [_median(own) for own in colours],
        "ratios": [_median(own[:, None])[0] for own in ratios],
        "rows": [
            {
                "angles": [round(float(coordinates[name][k]), 1) for name in COORDINATES[:4]],
                "colours": [own[k].tolist() for own in colours],
                "ratio": float(model[k]),
            }
            for k in worst
        ],
        "names": names,
        "marks": {name: coordinates[name][marked] for name in COORDINATES}
        | {"value": shown[0][marked]},
    }


def _median(values: FloatArray) -> list[float]:
    """Return the median of each channel of values (n, channels); -1 of no values."""
    if not len(values):
        return [-1.0] * values.shape[1]
    return [float(number) for number in np.median(values, axis=0)]


def describe_selection(curves: list[Curve], content: dict[str, Any]) -> str:
    """Return the selection in words: how many samples, and each material's median ratio."""
    if not content["rows"]:
        return "Nothing was measured there."
    count = content["count"]
    samples = f"{count:,} sample{'s' if count > 1 else ''}"
    what = samples if count else "No sample; interpolated values"
    pairs = zip(content["names"][1:], content["ratios"][1:], strict=True)
    return f"{what} selected. " + "; ".join(f"{name} / data {ratio:.3g}" for name, ratio in pairs)
