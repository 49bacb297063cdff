"""Directions that a BSDF draws once for a grid of views, and that are stored for all pictures.

For each view, the BSDF's constant part is stored. For each of its directions, the half vector, the
concentration κ of the lobe and the weight are stored. A surface point uses those of the nearest
view, and reflects its own view about the half vectors. Pictures do not evaluate the BSDF, and thus
are as fast with a measured table as with a formula.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from brdfkit.core.array_types import (
    JitColour,
    JitFloat,
    JitInt,
    JitMask,
    JitVector,
    MitsubaObject,
)
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.vectors import reflect
from brdfkit.lighting.filtering.bsdf_directions import Directions, split_off_constant
from brdfkit.lighting.filtering.filtered_light import Light
from brdfkit.lighting.filtering.scene_bsdfs import (
    find_period,
    has_separate_diffuse_part,
    split_component_types,
)
from brdfkit.mitsuba_bridge.arrays import Rows, find_cell
from brdfkit.mitsuba_bridge.channels import make_rgb_emission

# Numbers of (polar angles, azimuths) of the views that are stored for a BSDF, by the turn that
# leaves it unchanged, within which the azimuths are
GRIDS = {0.0: (256, 1), np.pi: (96, 32), 2 * np.pi: (96, 64)}
ADJACENT = 5  # number of adjacent polar angles whose median weight replaces outliers


class ViewDirections:
    """Directions that a BSDF draws for a grid of views, to light pictures without the BSDF.

    The views see the front of the surface, and the back if the BSDF has one. Kernels do not depend
    on the grid, so that a BSDF may become anisotropic without a new one.
    """

    def __init__(self, bsdf: MitsubaObject, directions: Directions) -> None:
        import drjit as dr
        import mitsuba as mi

        self.directions = directions
        self.has_back = mi.has_flag(bsdf.flags(), mi.BSDFFlags.BackSide)
        period = find_period(bsdf)
        angles, azimuths = GRIDS[period]
        views = _load_views(str(mi.variant()), period, self.has_back)
        self.angles, self.azimuths = mi.UInt32(angles), mi.UInt32(azimuths)
        self.angles_per_radian = mi.Float(2 / np.pi * angles)
        self.period = mi.Float(period or 2 * np.pi)
        dr.make_opaque(self.angles, self.azimuths, self.angles_per_radian, self.period)

        index = dr.arange(mi.UInt32, views.count * directions.count)
        view, number = index // directions.count, index % directions.count
        si = _make_surface_points(views.directions.at(view, mi.Vector3f))
        # Without other components there is nothing to separate, and one kernel serves all values
        has_others = int(bsdf.flags()) & split_component_types(mi)[1] != 0
        separate = has_others and has_separate_diffuse_part(bsdf)
        c, types, constant = split_off_constant(bsdf, si, True, separate)
        wo, kappa, weight = directions.draw_direction(number, bsdf, si, types, constant)
        h = dr.normalize(si.wi + wo)
        self.lobes = dr.ravel(mi.Vector4f(h.x, h.y, h.z, kappa))
        self.weights = dr.ravel(_append_zero(weight, len(index)))
        self.constants = dr.ravel(_append_zero(c, len(index)))
        dr.eval(self.lobes, self.weights, self.constants)
        self.weights = self._remove_weight_outliers(self.weights, index)
        dr.eval(self.weights)

    def _remove_weight_outliers(self, weights: JitFloat, index: JitInt) -> JitFloat:
        """Replace `weights` (views · directions, 4) by each direction's median in adjacent views.

        The first three columns are the colour of a weight, the fourth one is not used. `index`
        counts the rows. Weights change little from view to view, except where a measured table's
        cell is drawn too rarely: then a single view would be too bright, and show as a ring in
        pictures.
        """
        import drjit as dr
        import mitsuba as mi

        step = self.azimuths * self.directions.count  # rows from one polar angle to the next
        angle, last = mi.Int32((index // step) % self.angles), mi.Int32(self.angles) - 1
        rest = mi.Int32(index) - angle * mi.Int32(step)
        adjacent = []
        for offset in range(-(ADJACENT // 2), ADJACENT // 2 + 1):
            at = angle + offset  # reflected at both ends, where the end itself counts twice
            at = dr.select(at < 0, -at - 1, dr.select(at > last, 2 * last + 1 - at, at))
            row = mi.UInt32(rest + at * mi.Int32(step))
            adjacent.append(dr.gather(mi.Vector4f, weights, row))
        return dr.ravel(_median(adjacent))

    def find_sharpest_lobe(self) -> float:
        """Return the largest concentration κ of all stored lobes."""
        return float(np.array(self.lobes)[3::4].max())

    def find_nearest_view(self, wi: JitVector) -> tuple[JitInt, JitFloat]:
        """Return the number of the view that is nearest to the direction `wi` when it is turned.

        The second number is this turn about the normal [rad].
        """
        import drjit as dr
        import mitsuba as mi

        azimuths = mi.Float(self.azimuths)
        row = find_cell(dr.safe_acos(dr.abs(wi.z)) * self.angles_per_radian, mi.Float(self.angles))
        azimuth = dr.atan2(wi.y, wi.x)
        place = azimuth / self.period * azimuths + 0.5
        periods = dr.floor(place / azimuths)
        view = row * self.azimuths + find_cell(place - azimuths * periods, azimuths)
        # An isotropic BSDF has views of one azimuth alone
        turn = dr.select(self.azimuths == 1, azimuth, periods * self.period)
        return view + dr.select(wi.z < 0, self.angles * self.azimuths, 0), turn

    def radiance(self, si: MitsubaObject, light: Light, active: JitMask) -> JitColour:
        """Return the radiance that the points `si` reflect towards `si.wi`, as a spectrum."""
        import drjit as dr
        import mitsuba as mi

        active = mi.Bool(active) if self.has_back else active & (si.wi.z > 0)
        directions, (view, turn) = self.directions, self.find_nearest_view(si.wi)
        sin, cos = dr.sincos(turn)

        def add_direction(i: JitInt, total: JitColour) -> tuple[JitInt, JitColour]:
            index = view * directions.count + directions.find_direction_index(i, si)
            lobe, weight = (
                dr.gather(mi.Vector4f, rows, index, active) for rows in (self.lobes, self.weights)
            )
            h = mi.Vector3f(cos * lobe.x - sin * lobe.y, sin * lobe.x + cos * lobe.y, lobe.z)
            mean = light.mean_radiance_over_lobe(si.to_world(reflect(si.wi, h)), lobe.w)
            return i + 1, total + mi.Color3f(weight.x, weight.y, weight.z) * mean

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(0)),
            lambda i, total: active & (i < directions.per_ray),
            add_direction,
        )
        c = dr.gather(mi.Vector4f, self.constants, view * directions.count, active)
        received = light.irradiance(si.to_world(mi.Vector3f(0, 0, dr.sign(si.wi.z))))
        total = total / directions.per_ray + dr.pi * mi.Color3f(c.x, c.y, c.z) * received
        return make_rgb_emission()(dr.maximum(dr.select(active, total, 0), 0), si)


@dataclass(frozen=True)
class Views:
    """The `count` directions of a grid of views: azimuth fastest, then polar angle, then side."""

    directions: Rows
    count: int


@lru_cache(maxsize=8)
def _load_views(variant: str, period: float, has_back: bool) -> Views:
    """Return the views of a grid; the `variant` of Mitsuba is a key of the cache only."""
    angles, azimuths = GRIDS[period]
    theta = (np.arange(angles) + 0.5) / angles * np.pi / 2
    phi = np.arange(azimuths) / azimuths * period
    front = from_angles(theta[:, None], phi).reshape(-1, 3)
    views = np.concatenate([front, front * [1, 1, -1]]) if has_back else front
    return Views(Rows(views), len(views))


def _make_surface_points(wi: JitVector) -> MitsubaObject:
    """Return a `mi.SurfaceInteraction3f` of points with the normal z, seen from `wi`."""
    import drjit as dr
    import mitsuba as mi

    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(wi))
    si.wi, si.n = wi, mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    return si


def _append_zero(colour: JitColour, count: int) -> JitVector:
    """Return a colour (grey in mono variants), of `count` points or of all, and 0 as a vector."""
    import drjit as dr
    import mitsuba as mi

    parts = [colour[k] for k in range(len(colour))]
    wide = dr.zeros(mi.Float, count)
    return mi.Vector4f(*(part + wide for part in (parts * 3)[:3]), wide)


def _median(five: list[JitVector]) -> JitVector:
    """Return the median of five vectors, component by component."""
    import drjit as dr

    a, b, c, d, e = five
    a, b = dr.minimum(a, b), dr.maximum(a, b)
    c, d = dr.minimum(c, d), dr.maximum(c, d)
    # The least and the greatest of the first four are not the median of all
    low, high = dr.maximum(a, c), dr.minimum(b, d)
    low, high = dr.minimum(low, high), dr.maximum(low, high)
    return dr.maximum(low, dr.minimum(high, e))
