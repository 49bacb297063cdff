"""Computes the polar plot: BRDFs over the angle of view, for one direction of the light."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured import Measured
from brdfkit.viewing.materials.curves import Curve
from brdfkit.viewing.materials.plots.measured_points import SCATTER_REACH, MeasuredPoints, is_known
from brdfkit.viewing.materials.plots.sampler import compute_sampler_lobe
from brdfkit.viewing.materials.plots.settings import PlotSettings, make_grid_around

END = 89.0  # largest angle of view [degrees]: at 90° many models are not finite


def compute_lobe(material: Any, settings: PlotSettings) -> dict[str, FloatArray]:
    """Return a material's BRDF over the angle of view.

    "theta_o" (n,): the angles [degrees], negative on the light's side. "values" (n, channels):
    the BRDF [sr⁻¹]. "known" (n,): whether it was measured there. "points" and "point_values": the
    angles (m,) and the values (m, channels) of measured samples near by.
    """
    theta_o, wi, wo = make_views(settings)
    lobe = {
        "theta_o": theta_o,
        "values": material.eval(wi, wo),
        "known": is_known(material, wi, wo),
    }
    if isinstance(material, Measured):
        near = MeasuredPoints.of(material).find_near(
            settings.theta_i, settings.phi_i, settings.phi_o
        )
        lobe["points"], lobe["point_values"] = near
    elif settings.sampler:
        lobe["sampler"] = compute_sampler_lobe(material, settings, wi, wo)
    return lobe


def make_views(settings: PlotSettings) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return angles of view (n,) [degrees], and the directions wi and wo (n, 3) that they mean."""
    behind = make_grid_around(-settings.theta_i, -END, END)
    theta_o = np.union1d(behind, make_grid_around(settings.theta_i, -END, END))
    wi = from_angles(np.radians(settings.theta_i), np.radians(settings.phi_i))
    azimuth = np.radians(settings.phi_i + 180 + settings.phi_o)
    return (
        theta_o,
        np.broadcast_to(wi, (len(theta_o), 3)),
        from_angles(np.radians(theta_o), azimuth),
    )


def arrange_lobes(
    curves: list[tuple[Curve, dict[str, FloatArray]]], settings: PlotSettings
) -> dict[str, Any]:
    """Return the polar plot of curves with their lobes, in the channels that are shown."""
    shown = []
    for _, lobe in curves:
        cosine = np.cos(np.radians(lobe["theta_o"])) if settings.weighted else 1.0
        own = {
            "theta_o": lobe["theta_o"],
            "values": settings.pick(lobe["values"]).T * cosine,
            "known": lobe["known"],
        }
        if "points" in lobe:
            cosine = np.cos(np.radians(lobe["points"])) if settings.weighted else 1.0
            own["points"] = lobe["points"]
            own["point_values"] = settings.pick(lobe["point_values"]).T * cosine
        if "sampler" in lobe:
            own["sampler"] = lobe["sampler"]
        shown.append(own)
    data = next((c.material for c, _ in curves if c.is_measured), None)
    return {
        "theta_i": settings.theta_i,
        "cosine": settings.weighted,
        "reach": list(MeasuredPoints.of(data).reach if data else SCATTER_REACH),
        "lobes": shown,
    }


def describe_lobes(curves: list[Curve], content: dict[str, Any]) -> str:
    """Return the polar plot in words: where each lobe is largest, and how large."""
    parts = []
    for curve, lobe in zip(curves, content["lobes"], strict=True):
        values = np.where(lobe["known"], lobe["values"].mean(axis=0), np.nan)
        if not np.isfinite(values).any():
            parts.append(f"{curve.name}: not measured")
            continue
        at = int(np.nanargmax(values))
        place = f"{lobe['theta_o'][at]:.0f}°".replace("-", "−")
        parts.append(f"{curve.name}: largest at {place}, {values[at]:.3g}")
    return f"Lobes for light at {content['theta_i']:g}°. " + "; ".join(parts)
