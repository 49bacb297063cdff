"""Computes the plot of samples: measured values over an angle, each beside the models' values."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.materials.auditing.noise import estimate_noise
from brdfkit.materials.measured import Measured
from brdfkit.viewing.materials.curves import Curve
from brdfkit.viewing.materials.plots.measured_points import MeasuredPoints
from brdfkit.viewing.materials.plots.settings import PlotSettings
from brdfkit.viewing.materials.plots.slices import LARGEST_RATIO, RATIO_COLOURS, sample_colours

MOST_SAMPLES = 2500  # that are shown
BINS = 50  # of the square root of θh, from each of which equally many samples are drawn
LEAST_RATIO = 1e-3  # smallest value in a ratio, over the median


def draw_samples(material: Any, settings: PlotSettings) -> dict[str, Any]:
    """Return samples of a measurement, evenly over √θh, with what all models need of them.

    "wi", "wo" (n, 3), "values" (n, channels), "theta_h" and "theta_o" (n,) [degrees]; "noise": the
    relative standard deviation (channels,) of a value, NaN if unknown. Of a model, nothing.
    """
    if not isinstance(material, Measured):
        return {}
    samples = material.samples
    rows = MeasuredPoints.of(material).rows
    random = np.random.default_rng(0)
    rows = rows[random.permutation(len(rows))[: 20 * MOST_SAMPLES]]
    theta_h = np.degrees(to_half_difference(samples.wi[rows], samples.wo[rows])[0])
    bins = np.minimum((np.sqrt(theta_h / 90) * BINS).astype(int), BINS - 1)
    # The place of each sample in its bin: the first ones of all bins are shown
    order = np.argsort(bins, kind="stable")
    place = np.empty(len(rows), int)
    counts = np.bincount(bins, minlength=BINS)
    place[order] = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    shown = np.sort(np.argsort(place, kind="stable")[:MOST_SAMPLES])
    rows, theta_h = rows[shown], theta_h[shown]
    return {
        "wi": samples.wi[rows],
        "wo": samples.wo[rows],
        "values": samples.values[rows],
        "theta_h": theta_h,
        "theta_o": np.degrees(np.arccos(np.clip(samples.wo[rows, 2], -1, 1))),
        "noise": np.array(estimate_noise(material).relative),
    }


def arrange_samples(
    curves: list[tuple[Curve, dict[str, Any]]], settings: PlotSettings
) -> dict[str, Any]:
    """Return the samples, and the values and the ratios (logarithm to base 2) of each model there.

    "noise" is the relative standard deviation of a value, 0 if unknown.
    """
    found = next((own for curve, own in curves if curve.is_measured), None)
    if found is None:
        return {"failed": True}
    values = settings.pick_one(found["values"])
    models = []
    least = LEAST_RATIO * max(float(np.median(values)), 1e-12)
    for curve, _ in curves:
        if curve.is_measured:
            continue
        own = settings.pick_one(curve.material.eval(found["wi"], found["wo"]))
        ratio = np.log2(np.maximum(own, least) / np.maximum(values, least))
        models.append({"values": own, "ratio": ratio})
    noise = found["noise"][np.isfinite(found["noise"])]
    return {
        "theta_h": found["theta_h"],
        "theta_o": found["theta_o"],
        "values": values,
        "noise": float(noise.mean()) if noise.size else 0.0,
        "models": models,
        "colours": sample_colours(RATIO_COLOURS),
        "largest_ratio": LARGEST_RATIO,
    }


def describe_samples(curves: list[Curve], content: dict[str, Any]) -> str:
    """Return the plot of samples in words: how many are within the noise, and how far the rest."""
    if "models" not in content:
        return "There are no measured samples: a model is shown alone."
    models = [curve.name for curve in curves if not curve.is_measured]
    parts = []
    for name, model in zip(models, content["models"], strict=True):
        factor = 2 ** float(np.median(np.abs(model["ratio"])))
        parts.append(f"{name}: typically a factor of {factor:.3g} from the data")
    noise = f", noise {100 * content['noise']:.2g} %" if content["noise"] else ""
    return f"{len(content['values']):,} samples{noise}. " + "; ".join(parts)
