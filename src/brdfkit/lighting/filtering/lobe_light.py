"""Lighting by spherical Gaussians: a material's lobes for a view, with one look-up for each.

    L(o) ≈ d(o) E + Σ_k w_k(o) · L filtered by the lobe μ_k(o), κ_k(o)

with the irradiance E divided by π, and the light's radiance L. The view o, the albedo d and the
lobes are those of a `LobeTable`, interpolated between its views. [Ergun 2015, sections 8.3, 8.5,
8.6]
"""

import numpy as np

from brdfkit.core.array_types import JitColour, JitFloat, JitInt, JitMask, JitVector, MitsubaObject
from brdfkit.lighting.filtering.filtered_light import Light
from brdfkit.lighting.filtering.scene_bsdfs import CacheByValues, distinct_bsdfs, is_isotropic
from brdfkit.lighting.spherical_gaussians.lobe_table import LobeTable, lobe_table
from brdfkit.mitsuba_bridge.arrays import Rows, find_bracket, find_periodic_bracket
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf
from brdfkit.mitsuba_bridge.channels import make_rgb_emission

AZIMUTHS = 16  # of the views of an anisotropic BSDF


class LobeLight:
    """Lights surfaces by lobes, `count` per view, that a `method` fits to the BSDFs of a scene."""

    def __init__(self, method: str, count: int) -> None:
        self.method, self.count = method, count
        self.lobes = CacheByValues(self.fit)

    def radiance(
        self,
        scene: MitsubaObject,
        sampler: MitsubaObject,
        si: MitsubaObject,
        light: Light,
        active: JitMask,
    ) -> JitColour:
        """Return the radiance towards `si.wi`, a spectrum of the current variant."""
        import drjit as dr
        import mitsuba as mi

        bsdf, total = si.bsdf(), mi.Color3f(0)
        for each, lobes in self.lobes.get(distinct_bsdfs(scene)):
            here = active & (bsdf == mi.BSDFPtr(each))
            if not mi.has_flag(each.flags(), mi.BSDFFlags.BackSide):
                here &= si.wi.z > 0
            total = dr.select(here, lobes.radiance(si, light, here), total)
        return make_rgb_emission()(total, si)

    def fit(self, bsdf: MitsubaObject) -> "ViewedLobes":
        """Fit lobes to a BSDF, which takes a few seconds."""
        import mitsuba as mi

        if mi.has_flag(bsdf.flags(), mi.BSDFFlags.Delta):
            mi.Log(  # type: ignore[operator]  # an object in Mitsuba's stub
                mi.LogLevel.Warn,
                f"{bsdf.id()}: the lobes of {self.method} leave mirrors and clear glass black; "
                "take filtered_sampling.",
            )
        azimuths = 1 if is_isotropic(bsdf) else AZIMUTHS
        return ViewedLobes(
            lobe_table(
                lambda wi, wo: eval_bsdf(bsdf, wo, wi), self.method, self.count, azimuths=azimuths
            )
        )


class ViewedLobes:
    """A `LobeTable` in Mitsuba, whose lobes are interpolated between its views."""

    def __init__(self, table: LobeTable) -> None:
        self.views, self.azimuths = len(table.theta_o), len(table.phi_o)
        self.step = float(table.theta_o[1])
        self.count = table.kappa.shape[1]
        weights = np.broadcast_to(table.weights, (*table.kappa.shape, 3))
        self.weights = Rows(
            np.concatenate([weights, table.kappa[..., None]], axis=-1).reshape(-1, 4)
        )
        self.axes = Rows(np.pad(table.axes.reshape(-1, 3), ((0, 0), (0, 1))))
        self.diffuse = Rows(np.broadcast_to(table.diffuse, (len(table.diffuse), 3)))

    def radiance(self, si: MitsubaObject, light: Light, active: JitMask) -> JitColour:
        """Return the radiance towards `si.wi`, linear sRGB, the same on both sides."""
        import drjit as dr
        import mitsuba as mi

        side = dr.sign(si.wi.z)
        corners, sin_phi, cos_phi = self.find_views(mi.Vector3f(si.wi.x, si.wi.y, dr.abs(si.wi.z)))

        def interpolate(rows: Rows, kind: type, lobe: JitInt = 0, count: int = 1) -> JitVector:
            return sum(share * rows.at(view * count + lobe, kind) for view, share in corners)

        def add_lobe(k: JitInt, total: JitColour) -> tuple[JitInt, JitColour]:
            weight = interpolate(self.weights, mi.Vector4f, k, self.count)
            axis = interpolate(self.axes, mi.Vector4f, k, self.count)
            x, y = cos_phi * axis.x - sin_phi * axis.y, sin_phi * axis.x + cos_phi * axis.y
            axis = si.to_world(dr.normalize(mi.Vector3f(x, y, axis.z * side)))
            mean = light.mean_over_lobe(axis, weight.w)
            return k + 1, total + mi.Color3f(weight.x, weight.y, weight.z) * mean

        irradiance = light.irradiance(si.to_world(mi.Vector3f(0, 0, side)))
        matte = interpolate(self.diffuse, mi.Color3f) * irradiance
        _, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(matte)), lambda k, total: active & (k < self.count), add_lobe
        )
        return dr.select(active, total, 0)

    def find_views(self, wo: JitVector) -> tuple[list[tuple[JitInt, JitFloat]], JitFloat, JitFloat]:
        """Return the views around `wo`, as (number, share), and the sine and cosine of its azimuth.

        The lobes turn by that azimuth.
        """
        import drjit as dr

        lower, upper, t = find_bracket(dr.safe_acos(wo.z) / self.step, self.views)
        rows = (lower, 1 - t), (upper, t)
        columns: tuple[tuple[JitInt, JitFloat], ...] = ((0, 1),)
        phi = dr.atan2(wo.y, wo.x)
        if self.azimuths > 1:
            turn = phi / (2 * dr.pi) * self.azimuths
            left, right, s = find_periodic_bracket(turn, self.azimuths)
            columns = (left, 1 - s), (right, s)
        views = [(i * self.azimuths + j, a * b) for i, a in rows for j, b in columns]
        return views, *dr.sincos(phi)
