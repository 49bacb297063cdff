"""Lighting by spherical Gaussians: one look-up in the filtered light for each lobe of a material.

The radiance that a surface reflects towards the view o is

    d(o) E + Σ_k w_k(o) · L filtered by the lobe with the axis μ_k(o) and concentration κ_k(o)

with the irradiance E divided by π, and the environment's radiance L. A `LobeTable` has the albedo d
of the diffuse part, and the lobes with their weights w, which are interpolated between its views.
[Ergun 2015, sections 8.3, 8.5, 8.6]
"""

from math import inf

import numpy as np

from brdfkit.core.array_types import JitColour, JitFloat, JitInt, JitMask, JitVector, MitsubaObject
from brdfkit.lighting.filtering.filtered_light import Light
from brdfkit.lighting.filtering.scene_bsdfs import CacheByValues, is_isotropic, list_distinct_bsdfs
from brdfkit.lighting.spherical_gaussians.lobe_table import LobeTable, fit_lobe_table
from brdfkit.mitsuba_bridge.arrays import Rows, find_bracket, find_periodic_bracket
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf
from brdfkit.mitsuba_bridge.channels import make_rgb_emission

AZIMUTHS = 16  # number of azimuths of the views to which an anisotropic BSDF is fitted


class LobeLight:
    """Lights surfaces by spherical Gaussians that are fitted to the BSDFs of a scene.

    `method` is a name of `lobe_table.METHODS`, and `count` the number of lobes per view.
    """

    shadow_sharpness = 1.0  # the lobes are the BSDF's own shape, and shadow rays fill them

    def __init__(self, method: str, count: int) -> None:
        self.method, self.count = method, count
        self.lobes = CacheByValues(self.fit_lobes)

    def radiance(
        self,
        scene: MitsubaObject,
        sampler: MitsubaObject,
        si: MitsubaObject,
        light: Light,
        active: JitMask,
    ) -> JitColour:
        """Return the radiance that the surfaces at `si` reflect towards `si.wi`.

        It is a spectrum of the current variant. The `light` is filtered; `sampler` is not used.
        """
        import drjit as dr
        import mitsuba as mi

        bsdf, total = si.bsdf(), mi.Color3f(0)
        for each, lobes in self.lobes.get_or_make_results(list_distinct_bsdfs(scene)):
            here = active & (bsdf == mi.BSDFPtr(each))
            if not mi.has_flag(each.flags(), mi.BSDFFlags.BackSide):
                here &= si.wi.z > 0
            total = dr.select(here, lobes.radiance(si, light, here), total)
        return make_rgb_emission()(total, si)

    def find_sharpest_lobe(self, scene: MitsubaObject, sampler: MitsubaObject) -> float:
        """Return the largest concentration κ of the lobes of light, which is not known."""
        return inf

    def fit_lobes(self, bsdf: MitsubaObject) -> "ViewedLobes":
        """Fit lobes to a BSDF, in a few seconds; warn if it has a mirror or clear glass."""
        import mitsuba as mi

        if mi.has_flag(bsdf.flags(), mi.BSDFFlags.Delta):
            mi.Log(  # type: ignore[operator]  # Mitsuba's stub declares no function
                mi.LogLevel.Warn,
                f"{bsdf.id()}: the lobes of {self.method} leave mirrors and clear glass black; "
                "take filtered_sampling.",
            )
        azimuths = 1 if is_isotropic(bsdf) else AZIMUTHS
        return ViewedLobes(
            fit_lobe_table(
                lambda wi, wo: eval_bsdf(bsdf, wo, wi), self.method, self.count, azimuths=azimuths
            )
        )


class ViewedLobes:
    """A `LobeTable` in Mitsuba's memory, whose lobes are interpolated between its views."""

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
        """Return the radiance that the points `si` reflect towards `si.wi`, in linear sRGB.

        Both sides of a surface reflect alike.
        """
        import drjit as dr
        import mitsuba as mi

        side = dr.sign(si.wi.z)
        corners, sin_phi, cos_phi = self.find_surrounding_views(
            mi.Vector3f(si.wi.x, si.wi.y, dr.abs(si.wi.z))
        )

        def interpolate_views(
            rows: Rows, kind: type, lobe: JitInt = 0, count: int = 1
        ) -> JitVector:
            return sum(share * rows.at(view * count + lobe, kind) for view, share in corners)

        def add_lobe(k: JitInt, total: JitColour) -> tuple[JitInt, JitColour]:
            weight = interpolate_views(self.weights, mi.Vector4f, k, self.count)
            axis = interpolate_views(self.axes, mi.Vector4f, k, self.count)
            x, y = cos_phi * axis.x - sin_phi * axis.y, sin_phi * axis.x + cos_phi * axis.y
            axis = si.to_world(dr.normalize(mi.Vector3f(x, y, axis.z * side)))
            mean = light.mean_radiance_over_lobe(axis, weight.w)
            return k + 1, total + mi.Color3f(weight.x, weight.y, weight.z) * mean

        irradiance = light.irradiance(si.to_world(mi.Vector3f(0, 0, side)))
        matte = interpolate_views(self.diffuse, mi.Color3f) * irradiance
        _, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(matte)), lambda k, total: active & (k < self.count), add_lobe
        )
        return dr.select(active, total, 0)

    def find_surrounding_views(
        self, wo: JitVector
    ) -> tuple[list[tuple[JitInt, JitFloat]], JitFloat, JitFloat]:
        """Find the stored views around `wo`, to interpolate the lobes between them.

        Returns them as (number, weight), and the sine and cosine of the azimuth of `wo`, by which
        the lobes have to be turned.
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
