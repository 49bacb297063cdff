"""Computes the plot of directional albedo: the share of light that is reflected, by incidence."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.materials.measured.albedos import LEAST_KNOWN_SHARE
from brdfkit.model import Model
from brdfkit.regression.albedo import (
    ANISOTROPIC_AZIMUTHS,
    ISOTROPIC_AZIMUTHS,
    make_albedo_pixels,
)
from brdfkit.viewing.materials.curves import Curve
from brdfkit.viewing.materials.plots.measured_points import is_known
from brdfkit.viewing.materials.plots.settings import PlotSettings

THETA_I = (0.0, *map(float, range(5, 86, 5)), 88.0)  # angles of incidence [degrees]


def compute_albedo_curve(material: Any, settings: PlotSettings) -> dict[str, FloatArray]:
    """Return the albedo "values" (n, channels) at the incidences "theta_i" (n,) [degrees].

    It is a mean over the azimuths of incidence. "known" (n,) tells where most of the light leaves
    in measured directions.
    """
    azimuths = ANISOTROPIC_AZIMUTHS if is_anisotropic(material) else ISOTROPIC_AZIMUTHS
    pixels = make_albedo_pixels(THETA_I, azimuths)
    share = pixels.evaluate(lambda wi, wo: is_known(material, wi, wo)[:, None].astype(float))
    unit = pixels.evaluate(lambda wi, wo: np.ones((len(wi), 1)))
    return {
        "theta_i": np.array(THETA_I),
        "values": pixels.evaluate(material.eval),
        "known": (share / unit)[:, 0] >= LEAST_KNOWN_SHARE,
    }


def is_anisotropic(material: Any) -> bool:
    """Return whether a material changes as the surface turns; for a model, whether with its values.

    A model is isotropic as long as parameters such as alpha_v equal those that they follow.
    """
    if isinstance(material, Model):
        free = material.free_values
        return any(parameter.turns and free.get(n) for n, parameter in material.parameters.items())
    return bool(getattr(material, "anisotropic", False))


def arrange_albedos(
    curves: list[tuple[Curve, dict[str, FloatArray]]], settings: PlotSettings
) -> dict[str, Any]:
    """Return the albedo plot of curves, in the channels that are shown.

    "channel" says what `describe_albedos` takes of them.
    """
    lines = [{**own, "values": settings.pick(own["values"]).T} for _, own in curves]
    channel = "mean of R, G and B" if settings.channel == "each" else settings.channel
    return {"lines": lines, "channel": channel}


def describe_albedos(curves: list[Curve], content: dict[str, Any]) -> str:
    """Return the albedo plot in words: the albedos at a few incidences."""
    parts = []
    for curve, line in zip(curves, content["lines"], strict=True):
        mean = line["values"].mean(axis=0)
        at = [THETA_I.index(angle) for angle in (5.0, 45.0, 75.0)]
        words = [f"{mean[k]:.3g} at {THETA_I[k]:g}°" for k in at if line["known"][k]]
        parts.append(f"{curve.name}: " + (", ".join(words) or "not measured"))
    return f"Albedo, {content['channel']}. " + "; ".join(parts)
