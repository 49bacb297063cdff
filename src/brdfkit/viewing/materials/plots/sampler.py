"""Computes the density with which the renderer draws directions of a model, beside its BRDF."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.jit.threads import in_turn
from brdfkit.materials.measured.albedos import make_outgoing_quadrature
from brdfkit.viewing.materials.live_bsdf import LiveBsdf
from brdfkit.viewing.materials.plots.settings import PlotSettings
from brdfkit.viewing.recent import Recent

MODELS = 4  # whose BSDFs are kept at most
_BSDFS: Recent[type, LiveBsdf] = Recent(MODELS)


def compute_sampler_lobe(
    model: Any, settings: PlotSettings, wi: FloatArray, wo: FloatArray
) -> FloatArray:
    """Return the density (n,) of the renderer's samples times the albedo, for pairs (n, 3).

    Where it equals the BRDF times cosθo, the sampling has no noise. The albedo is the luminance of
    the one for this direction of the light.
    """
    light = from_angles(np.radians(settings.theta_i), np.radians(settings.phi_i))
    views, weight = make_outgoing_quadrature(light)
    values = settings.pick_one(model.eval(np.broadcast_to(light, views.shape), views))
    albedo = float(weight @ values) * np.pi / weight.sum()
    return compute_density(model, wi, wo) * albedo


@in_turn
def compute_density(model: Any, wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return the density (n,) [sr⁻¹] with which a model's BSDF draws wo for wi, both (n, 3)."""
    import drjit as dr
    import mitsuba as mi

    live = _BSDFS.get(type(model), lambda: LiveBsdf(model))
    live.show(model)
    si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    si.wi, si.sh_frame = mi.Vector3f(wi.T), mi.Frame3f(mi.Vector3f(0, 0, 1))
    si.n = mi.Normal3f(0, 0, 1)
    density = live.front.pdf(mi.BSDFContext(), si, mi.Vector3f(wo.T))
    return np.asarray(density, float)
