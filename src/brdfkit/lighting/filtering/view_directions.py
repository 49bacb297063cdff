"""Directions that a BSDF draws once for a grid of views, and that are stored for all pictures.

For each view, the BSDF's constant part is stored. For each of its directions, the half vector, the
concentration κ of the lobe and the weight are stored. A surface point uses those of the nearest
view, and reflects its own view about the half vectors. Pictures do not evaluate the BSDF, and thus
are as fast with a measured table as with a formula.
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
from brdfkit.lighting.filtering.bsdf_directions import Directions, split_off_constant
from brdfkit.lighting.filtering.filtered_light import Light
from brdfkit.lighting.filtering.scene_bsdfs import has_separate_diffuse_part, is_isotropic
from brdfkit.mitsuba_bridge.arrays import Rows, find_cell
from brdfkit.mitsuba_bridge.channels import make_rgb_emission

# Numbers of (polar angles, azimuths) of the views that are stored for a BSDF
ISOTROPIC, ANISOTROPIC = (256, 1), (96, 64)
ADJACENT = 5  # number of adjacent polar angles whose median weight replaces outliers


class ViewDirections:
    """Directions that a BSDF draws for a grid of views, to light pictures without the BSDF.

    The views see the front of the surface, and the back if the BSDF has one.
    """

    def __init__(self, bsdf: MitsubaObject, directions: Directions) -> None:
        import drjit as dr
        import mitsuba as mi

        self.directions = directions
        self.angles, self.azimuths = ISOTROPIC if is_isotropic(bsdf) else ANISOTROPIC
        self.has_back = mi.has_flag(bsdf.flags(), mi.BSDFFlags.BackSide)

        si = _make_surface_points(np.repeat(self.make_views(), directions.count, axis=0))
        c, types, constant = split_off_constant(bsdf, si, True, has_separate_diffuse_part(bsdf))
        index = dr.arange(mi.UInt32, dr.width(si)) % directions.count
        wo, kappa, weight = directions.draw_direction(index, bsdf, si, types, constant)
        self.constants = Rows(_append_number(c, 0, len(index))[:: directions.count])
        self.lobes = Rows(_append_number(dr.normalize(si.wi + wo), kappa, len(index)))
        self.weights = Rows(self._remove_weight_outliers(_append_number(weight, 0, len(index))))

    def _remove_weight_outliers(self, weights: FloatArray) -> FloatArray:
        """Replace `weights` (views · directions, 4) by each direction's median in adjacent views.

        The first three columns are the colour of a weight, the fourth one is not used.
        Weights change little from view to view, except where a measured table's cell is drawn too
        rarely: then a single view would be too bright, and show as a ring in pictures.
        """
        from scipy.ndimage import median_filter

        views = weights.reshape(-1, self.angles, self.azimuths, self.directions.count, 4)
        return median_filter(views, (1, ADJACENT, 1, 1, 1)).reshape(weights.shape)

    def make_views(self) -> FloatArray:
        """Return the views' directions (n, 3): azimuth fastest, then polar angle, then side."""
        theta = (np.arange(self.angles) + 0.5) / self.angles * np.pi / 2
        phi = np.arange(self.azimuths) / self.azimuths * 2 * np.pi
        front = from_angles(theta[:, None], phi).reshape(-1, 3)
        return np.concatenate([front, front * [1, 1, -1]]) if self.has_back else front

    def find_nearest_view(self, wi: JitVector) -> JitInt:
        """Return the number of the stored view that is nearest to the direction `wi`."""
        import drjit as dr
        import mitsuba as mi

        row = find_cell(dr.safe_acos(dr.abs(wi.z)) * (2 / dr.pi * self.angles), self.angles)
        turn = dr.atan2(wi.y, wi.x) / (2 * dr.pi) * self.azimuths + 0.5
        turn -= self.azimuths * dr.floor(turn / self.azimuths)
        view = row * self.azimuths + find_cell(turn, self.azimuths)
        return view + dr.select(wi.z < 0, mi.UInt32(self.angles * self.azimuths), 0)

    def radiance(self, si: MitsubaObject, light: Light, active: JitMask) -> JitColour:
        """Return the radiance that the points `si` reflect towards `si.wi`, as a spectrum."""
        import drjit as dr
        import mitsuba as mi

        active = mi.Bool(active) if self.has_back else active & (si.wi.z > 0)
        directions, view = self.directions, self.find_nearest_view(si.wi)
        sin, cos = dr.sincos(dr.atan2(si.wi.y, si.wi.x) if self.azimuths == 1 else mi.Float(0))

        def add_direction(i: JitInt, total: JitColour) -> tuple[JitInt, JitColour]:
            index = view * directions.count + directions.find_direction_index(i, si)
            lobe, weight = (
                rows.at(index, mi.Vector4f, active) for rows in (self.lobes, self.weights)
            )
            h = mi.Vector3f(cos * lobe.x - sin * lobe.y, sin * lobe.x + cos * lobe.y, lobe.z)
            mean = light.mean_radiance_over_lobe(si.to_world(reflect(si.wi, h)), lobe.w)
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


def _make_surface_points(views: FloatArray) -> MitsubaObject:
    """Return a `mi.SurfaceInteraction3f` of points with the normal z, seen from `views` (n, 3)."""
    import drjit as dr
    import mitsuba as mi

    si = dr.zeros(mi.SurfaceInteraction3f, len(views))
    si.wi, si.n = mi.Vector3f(views.T.astype(np.float32)), mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    return si


def _append_number(vector: JitVector, number: AnyArray | float, count: int) -> FloatArray:
    """Append a number to a vector or colour (grey in mono variants): an array (count, 4)."""
    three = np.broadcast_to(np.array(vector), (3, count))
    return np.column_stack([*three, np.broadcast_to(np.array(number), count)])
