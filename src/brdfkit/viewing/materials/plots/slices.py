"""Computes slices of BRDFs over θh and θd: the data, the models, and their ratios to the data.

θh is the angle of the half vector to the normal, θd the angle between half vector and light, and φd
the azimuth of the light around the half vector.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_half_difference
from brdfkit.core.pages.images import apply_colour_map
from brdfkit.viewing.materials.curves import Curve
from brdfkit.viewing.materials.plots.measured_points import is_known
from brdfkit.viewing.materials.plots.settings import PlotSettings

CELLS = 64  # along each axis; those of θh are even in its square root, as highlights are narrow
VALUE_COLOURS, RATIO_COLOURS, STEPS = "viridis", "RdBu_r", 64
LARGEST_RATIO = 4.0  # at the end of the colours of ratios, which begin at its inverse
LEAST_COSINE = 1e-3  # to the normal, of a direction above the surface
FLOOR = 1e-3  # smallest value in a ratio, over the darkest colour's value


def compute_slice(material: Any, settings: PlotSettings) -> dict[str, FloatArray]:
    """Return the BRDF in the cells of a slice: "values" (θd, θh, channels), and "known" (θd, θh).

    Values are NaN where a direction lies below the surface.
    """
    wi, wo, above = make_slice_directions(settings.phi_d, settings.phi_i)
    values = material.eval(wi, wo)
    values[~above] = np.nan
    known = is_known(material, wi, wo) & above
    return {"values": values.reshape(CELLS, CELLS, -1), "known": known.reshape(CELLS, CELLS)}


@lru_cache(maxsize=2)
def make_slice_directions(phi_d: float, phi_h: float) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the directions wi, wo (n, 3) of the cells of a slice, and whether both are above.

    `phi_d` and `phi_h` are azimuths [degrees]. Pairs below the surface have the normal instead.
    """
    theta_h, theta_d = make_cells()
    h, d = np.meshgrid(np.radians(theta_h), np.radians(theta_d))
    wi, wo = (
        w.reshape(-1, 3) for w in from_half_difference(h, d, np.radians(phi_d), np.radians(phi_h))
    )
    above = (wi[:, 2] > LEAST_COSINE) & (wo[:, 2] > LEAST_COSINE)
    for w in (wi, wo):
        w[~above] = 0, 0, 1
    return wi, wo, above


def make_cells() -> tuple[FloatArray, FloatArray]:
    """Return the centres of the cells, θh and θd (n,) [degrees]."""
    share = (np.arange(CELLS) + 0.5) / CELLS
    return 90 * share**2, 90 * share


def arrange_slices(
    curves: list[tuple[Curve, dict[str, FloatArray]]], settings: PlotSettings
) -> dict[str, Any]:
    """Return the panels of the plot: the data, the shown model, and its ratio to the data.

    Pins are left out, for which there is no room. Ratios are logarithms to base 2.
    """
    shown = [(curve, settings.pick_one(own["values"]), own["known"]) for curve, own in curves[:2]]
    _, first, known = shown[0]
    low, high = find_range(first[known] if known.any() else first)
    panels = [make_panel(curve.name, "value", values, known) for curve, values, known in shown]
    if shown[0][0].is_measured:
        for curve, values, _ in shown[1:]:
            ratio = np.log2(np.maximum(values, FLOOR * low) / np.maximum(first, FLOOR * low))
            panels.append(make_panel(f"{curve.name} / data", "ratio", ratio, known))
    return {
        "phi_d": settings.phi_d,
        "panels": panels,
        "low": low,
        "high": high,
        "largest_ratio": LARGEST_RATIO,
        "value_colours": sample_colours(VALUE_COLOURS),
        "ratio_colours": sample_colours(RATIO_COLOURS),
    }


def make_panel(title: str, kind: str, values: FloatArray, known: FloatArray) -> dict[str, Any]:
    """Return one panel; `kind` is "value" or "ratio"."""
    return {"title": title, "kind": kind, "values": values, "known": known}


def find_range(values: FloatArray) -> tuple[float, float]:
    """Return the least and the largest value of the colours, without the outermost 1 % of values.

    The least is at most half of the largest.
    """
    positive = values[values > 0]
    if not positive.size:
        return 0.1, 1.0
    low, high = np.percentile(positive, (1, 99))
    return float(min(low, high / 2)), float(high)


@cache
def sample_colours(name: str) -> FloatArray:
    """Return a colour map as an array (steps, 3) of sRGB in 0 to 255."""
    colours: FloatArray = 255 * apply_colour_map(name, np.linspace(0, 1, STEPS))[:, :3]
    return colours


def describe_slices(curves: list[Curve], content: dict[str, Any]) -> str:
    """Return the slices in words: how far each model is from the data, typically and at most."""
    theta_h, theta_d = make_cells()
    parts = []
    for panel in content["panels"]:
        if panel["kind"] == "ratio" and panel["known"].any():
            ratio = np.where(panel["known"], panel["values"], np.nan)
            d, h = np.unravel_index(np.nanargmax(np.abs(ratio)), ratio.shape)
            typical = 2 ** np.nanmedian(np.abs(ratio))
            parts.append(
                f"{panel['title']}: typically a factor of {typical:.3g}, farthest at θh "
                f"{theta_h[h]:.0f}°, θd {theta_d[d]:.0f}°: {2 ** ratio[d, h]:.2g}"
            )
    parts = parts or [f"of {panel['title']}" for panel in content["panels"]]
    return f"Slices at φd = {content['phi_d']:g}°. " + "; ".join(parts)
