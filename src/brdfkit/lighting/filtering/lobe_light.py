"""Materials as lobes per view, lit by a filtered map: one look-up per lobe.

L(o) ≈ d(o) E + Σ_k w_k(o) L filtered by the lobe μ_k(o), κ_k(o)

with the lobes interpolated between the views of a `LobeTable`. [Ergun 2015, sections 8.3, 8.5, 8.6]
"""

import numpy as np

from brdfkit.lighting.filtering.scene_bsdfs import KeptByValues, bsdfs_of, is_isotropic
from brdfkit.lighting.spherical_gaussians.lobe_table import lobe_table
from brdfkit.mitsuba_bridge.arrays import Rows, bracket, periodic_bracket
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf
from brdfkit.mitsuba_bridge.channels import emission_of_rgb

AZIMUTHS = 16  # of the views of an anisotropic BSDF


class LobeLight:
    """Light by lobes that are fitted to the BSDFs of a scene by a `method`, `count` per view."""

    def __init__(self, method, count):
        self.method, self.count = method, count
        self.lobes = KeptByValues(self.fit)

    def radiance(self, scene, sampler, si, light, active):
        """The radiance towards `si.wi`, a spectrum of the current variant."""
        import drjit as dr
        import mitsuba as mi

        bsdf, total = si.bsdf(), mi.Color3f(0)
        for each, lobes in self.lobes.of(bsdfs_of(scene)):
            here = active & (bsdf == mi.BSDFPtr(each))
            if not mi.has_flag(each.flags(), mi.BSDFFlags.BackSide):
                here &= si.wi.z > 0
            total = dr.select(here, lobes.radiance(si, light, here), total)
        return emission_of_rgb()(total, si)

    def fit(self, bsdf):
        """The lobes of a BSDF, a few seconds."""
        import mitsuba as mi

        if mi.has_flag(bsdf.flags(), mi.BSDFFlags.Delta):
            mi.Log(
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
    """A `LobeTable` in Mitsuba."""

    def __init__(self, table):
        self.views, self.azimuths = len(table.theta_o), len(table.phi_o)
        self.step = float(table.theta_o[1])
        self.count = table.kappa.shape[1]
        ones = (*table.kappa.shape, 3)
        weights = np.broadcast_to(table.weights, ones)
        self.weights = Rows(
            np.concatenate([weights, table.kappa[..., None]], axis=-1).reshape(-1, 4)
        )
        self.axes = Rows(np.pad(table.axes.reshape(-1, 3), ((0, 0), (0, 1))))
        self.diffuse = Rows(np.broadcast_to(table.diffuse, (len(table.diffuse), 3)))

    def radiance(self, si, light, active):
        """The radiance towards `si.wi`, linear sRGB: the same on both sides of the surface."""
        import drjit as dr
        import mitsuba as mi

        side = dr.sign(si.wi.z)
        corners, sin_phi, cos_phi = self.around(mi.Vector3f(si.wi.x, si.wi.y, dr.abs(si.wi.z)))

        def mean(rows, kind, lobe=0, count=1):
            return sum(share * rows.at(view * count + lobe, kind) for view, share in corners)

        def one(k, total):
            weight = mean(self.weights, mi.Vector4f, k, self.count)
            axis = mean(self.axes, mi.Vector4f, k, self.count)
            x, y = cos_phi * axis.x - sin_phi * axis.y, sin_phi * axis.x + cos_phi * axis.y
            axis = si.to_world(dr.normalize(mi.Vector3f(x, y, axis.z * side)))
            seen = light.over_lobe(axis, weight.w)
            return k + 1, total + mi.Color3f(weight.x, weight.y, weight.z) * seen

        matte = mean(self.diffuse, mi.Color3f) * light.irradiance(
            si.to_world(mi.Vector3f(0, 0, side))
        )
        _, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(matte)), lambda k, total: active & (k < self.count), one
        )
        return dr.select(active, total, 0)

    def around(self, wo):
        """The views around `wo`, as (number, share), and the sine and cosine of its azimuth, with
        which their lobes turn."""
        import drjit as dr

        lower, upper, t = bracket(dr.safe_acos(wo.z) / self.step, self.views)
        rows, columns = ((lower, 1 - t), (upper, t)), ((0, 1),)
        phi = dr.atan2(wo.y, wo.x)
        if self.azimuths > 1:
            turn = phi / (2 * dr.pi) * self.azimuths
            left, right, s = periodic_bracket(turn, self.azimuths)
            columns = (left, 1 - s), (right, s)
        each = [(i * self.azimuths + j, a * b) for i, a in rows for j, b in columns]
        return each, *dr.sincos(phi)
