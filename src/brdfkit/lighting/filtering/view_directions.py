"""Directions of a BSDF that are drawn once for a grid of views, and serve every picture.

A view stores the constant part c, and for every direction the half vector h, the κ of its lobe and
its weight. A surface point takes those of the nearest view, and mirrors its own view about the half
vectors. A picture thus takes as long with a measured table as with a formula: it evaluates neither.
"""

import numpy as np

from brdfkit.core.array_types import (
    AnyArray,
    FloatArray,
    JitColour,
    JitInt,
    JitMask,
    JitVector,
    MitsubaObject,
)
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.vectors import reflect
from brdfkit.lighting.filtering.bsdf_directions import Directions, split_constant
from brdfkit.lighting.filtering.filtered_light import Light
from brdfkit.lighting.filtering.scene_bsdfs import has_matte_part, is_isotropic
from brdfkit.mitsuba_bridge.arrays import Rows, find_cell
from brdfkit.mitsuba_bridge.channels import make_rgb_emission

ISOTROPIC, ANISOTROPIC = (256, 1), (96, 64)  # polar angles and azimuths of the views
ADJACENT = 5  # polar angles over which the median of a direction's weights is taken


class ViewDirections:
    """The `directions` of a BSDF at views of its front, and of its back where it has one."""

    def __init__(self, bsdf: MitsubaObject, directions: Directions) -> None:
        import drjit as dr
        import mitsuba as mi

        self.directions = directions
        self.angles, self.azimuths = ISOTROPIC if is_isotropic(bsdf) else ANISOTROPIC
        self.has_back = mi.has_flag(bsdf.flags(), mi.BSDFFlags.BackSide)

        si = _make_points(np.repeat(self.make_views(), directions.count, axis=0))
        c, types, constant = split_constant(bsdf, si, True, has_matte_part(bsdf))
        index = dr.arange(mi.UInt32, dr.width(si)) % directions.count
        wo, kappa, weight = directions.draw(index, bsdf, si, types, constant)
        self.constants = Rows(_to_rows(c, 0, len(index))[:: directions.count])
        self.lobes = Rows(_to_rows(dr.normalize(si.wi + wo), kappa, len(index)))
        self.weights = Rows(self._remove_outliers(_to_rows(weight, 0, len(index))))

    def _remove_outliers(self, weights: FloatArray) -> FloatArray:
        """Replace `weights` (views · directions, 4) by each direction's median in adjacent views.

        A direction moves little from view to view, and so does its weight, unless it lies in a cell
        of a table that is drawn too rarely: then one view would be bright, and show as a ring.
        """
        from scipy.ndimage import median_filter

        views = weights.reshape(-1, self.angles, self.azimuths, self.directions.count, 4)
        return median_filter(views, (1, ADJACENT, 1, 1, 1)).reshape(weights.shape)

    def make_views(self) -> FloatArray:
        """Return the views (n, 3): the azimuth fastest, then the polar angle, then the side."""
        theta = (np.arange(self.angles) + 0.5) / self.angles * np.pi / 2
        phi = np.arange(self.azimuths) / self.azimuths * 2 * np.pi
        front = from_angles(theta[:, None], phi).reshape(-1, 3)
        return np.concatenate([front, front * [1, 1, -1]]) if self.has_back else front

    def nearest_view(self, wi: JitVector) -> JitInt:
        """Return the number of the view nearest to `wi`."""
        import drjit as dr
        import mitsuba as mi

        row = find_cell(dr.safe_acos(dr.abs(wi.z)) * (2 / dr.pi * self.angles), self.angles)
        turn = dr.atan2(wi.y, wi.x) / (2 * dr.pi) * self.azimuths + 0.5
        turn -= self.azimuths * dr.floor(turn / self.azimuths)
        view = row * self.azimuths + find_cell(turn, self.azimuths)
        return view + dr.select(wi.z < 0, mi.UInt32(self.angles * self.azimuths), 0)

    def radiance(self, si: MitsubaObject, light: Light, active: JitMask) -> JitColour:
        """Return the radiance towards `si.wi`, a spectrum of the current variant."""
        import drjit as dr
        import mitsuba as mi

        active = mi.Bool(active) if self.has_back else active & (si.wi.z > 0)
        directions, view = self.directions, self.nearest_view(si.wi)
        sin, cos = dr.sincos(dr.atan2(si.wi.y, si.wi.x) if self.azimuths == 1 else mi.Float(0))

        def add_direction(i: JitInt, total: JitColour) -> tuple[JitInt, JitColour]:
            index = view * directions.count + directions.index(i, si)
            lobe, weight = (
                rows.at(index, mi.Vector4f, active) for rows in (self.lobes, self.weights)
            )
            h = mi.Vector3f(cos * lobe.x - sin * lobe.y, sin * lobe.x + cos * lobe.y, lobe.z)
            mean = light.mean_over_lobe(si.to_world(reflect(si.wi, h)), lobe.w)
            return i + 1, total + mi.Color3f(weight.x, weight.y, weight.z) * mean

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(0)),
            lambda i, total: active & (i < directions.per_ray),
            add_direction,
        )
        c = self.constants.at(view, mi.Vector4f, active)
        received = light.irradiance(si.to_world(mi.Vector3f(0, 0, dr.sign(si.wi.z))))
        total = total / directions.per_ray + dr.pi * mi.Color3f(c.x, c.y, c.z) * received
        return make_rgb_emission()(dr.maximum(dr.select(active, total, 0), 0), si)


def _make_points(views: FloatArray) -> MitsubaObject:
    """Return surface points with the normal z that are seen from `views` (n, 3)."""
    import drjit as dr
    import mitsuba as mi

    si = dr.zeros(mi.SurfaceInteraction3f, len(views))
    si.wi, si.n = mi.Vector3f(views.T.astype(np.float32)), mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    return si


def _to_rows(vector: JitVector, number: AnyArray | float, count: int) -> FloatArray:
    """Return rows (count, 4) of a vector or colour (grey in mono variants) and a number."""
    three = np.broadcast_to(np.array(vector), (3, count))
    return np.column_stack([*three, np.broadcast_to(np.array(number), count)])
