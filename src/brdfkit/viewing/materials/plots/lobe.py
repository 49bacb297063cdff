"""Computes the 3-D lobe: a BRDF over all directions of view, for one direction of the light."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.viewing.materials.curves import Curve
from brdfkit.viewing.materials.plots.measured_points import is_known
from brdfkit.viewing.materials.plots.settings import PlotSettings

RINGS, SECTORS = 16, 40  # of the mesh, besides finer ones about the mirror direction
NEAR = (-12.0, -6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0, 12.0)  # degrees from the mirror direction
END = 88.0  # largest angle of view [degrees]


def compute_solid_lobe(material: Any, settings: PlotSettings) -> dict[str, FloatArray]:
    """Return the BRDF on a mesh of views: "values" (θo, φo, channels), and "known" (θo, φo).

    "theta_o" (n,) and "phi_o" (m,) [degrees] are the angles of the mesh. The azimuth is counted
    from the mirror direction; the last one is the first again.
    """
    theta_o, phi_o = make_mesh(settings.theta_i)
    theta, phi = np.meshgrid(np.radians(theta_o), np.radians(phi_o), indexing="ij")
    wo = from_angles(theta, phi + np.radians(settings.phi_i + 180)).reshape(-1, 3)
    wi = from_angles(np.radians(settings.theta_i), np.radians(settings.phi_i))
    wi = np.broadcast_to(wi, wo.shape)
    return {
        "theta_o": theta_o,
        "phi_o": phi_o,
        "values": material.eval(wi, wo).reshape(*theta.shape, -1),
        "known": is_known(material, wi, wo).reshape(theta.shape),
    }


def make_mesh(theta_i: float) -> tuple[FloatArray, FloatArray]:
    """Return polar angles and azimuths [degrees] of a mesh, dense about the mirror direction."""
    near = np.array(NEAR)
    theta = np.concatenate([np.linspace(0, END, RINGS), theta_i + near])
    theta = np.unique(np.clip(theta, 0, END).round(3))
    # A degree of azimuth is the smaller the steeper the mirror direction
    wide = near / max(np.sin(np.radians(theta_i)), 0.2)
    phi = np.concatenate([np.linspace(-180, 180, SECTORS + 1), wide])
    return theta, np.unique(np.clip(phi, -180, 180).round(3))


def arrange_solid_lobes(
    curves: list[tuple[Curve, dict[str, FloatArray]]], settings: PlotSettings
) -> dict[str, Any]:
    """Return the 3-D lobes of curves, in one channel."""
    lobes = []
    for _, own in curves:
        cosine = np.cos(np.radians(own["theta_o"]))[:, None] if settings.cosine else 1.0
        lobes.append({**own, "values": settings.pick_one(own["values"]) * cosine})
    return {"theta_i": settings.theta_i, "lobes": lobes}


def describe_solid_lobes(curves: list[Curve], content: dict[str, Any]) -> str:
    """Return the 3-D lobes in words: where each is largest."""
    parts = []
    for curve, lobe in zip(curves, content["lobes"], strict=True):
        row, column = np.unravel_index(np.nanargmax(lobe["values"]), lobe["values"].shape)
        parts.append(
            f"{curve.name}: largest at {lobe['theta_o'][row]:.0f}° to the normal, "
            f"{abs(lobe['phi_o'][column]):.0f}° beside the plane of incidence, "
            f"{lobe['values'][row, column]:.3g}"
        )
    return f"3-D lobes for light at {content['theta_i']:g}°. " + "; ".join(parts)
