"""A specimen of the virtual goniometer: a height field whose facets have BSDFs, and paths on it.

A directional light from wi, of irradiance E across its beam, falls on the plane of the mean height
with the irradiance E cosθ_i. The plane's radiance towards wo is the mean ⟨L⟩ over lines along wo
that are spread evenly over one tile of the height field. Hence the BRDF is

    f(wi, wo) = ⟨L⟩ / (E cosθ_i)
              = 1 / (A cosθ_i cosθ_o) ∫ f_facet (n·wi)⁺ (n·wo)⁺ V(wi) V(wo) dS + more bounces,

with A the area of the tile in the plane, S the surface, n its normal, ⁺ the positive part, and the
visibility V = 1 where nothing is in the way, else 0. One BRDF sample takes one such line. A path
follows the line down to the surface, and continues by sampling the BSDF of the facets. At every
bounce a shadow ray tests whether the light is visible.

The tile repeats without end: a ray that leaves it sideways enters it again on the other side.
"""

from collections.abc import Sequence
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import (
    FloatArray,
    IntArray,
    JitColour,
    JitInt,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.padding import pad
from brdfkit.materials.goniometer.microgeometry import HeightField

# Rays that leave the surface start at this distance above it [grid cells], lest they hit the facet
# that they leave. Single precision needs about 1e-4; with Mitsuba's own offset, 20 times larger
# than ours, grazing light reaches 1 % too far.
RAY_OFFSET = 1e-3
# a ray that crosses this many repetitions of the tile counts as missing the surface
MOST_TILES = 1000


class Specimen:
    """A Mitsuba scene of a `HeightField` with BSDFs, from which BRDF samples are drawn.

    `facets` is the dictionary of one Mitsuba BSDF, or of one for each part of the surface. Light
    that needs more than `max_bounces` reflections between facets is lost.
    """

    def __init__(
        self,
        surface: HeightField,
        facets: dict[str, Any] | Sequence[dict[str, Any]],
        max_bounces: int = 8,
    ) -> None:
        mi = _import_mitsuba()
        facets = [facets] if isinstance(facets, dict) else list(facets)
        if len(facets) == 1:
            facets *= len(surface.parts)
        if len(facets) != len(surface.parts):
            raise BrdfkitError(
                f"{len(facets)} materials were given for {' and '.join(surface.parts)}; "
                "give one, or one for each."
            )
        self.max_bounces = to_whole_number("max_bounces", max_bounces, 1)
        meshes = {
            name: _make_mesh(
                name, surface.vertices(), surface.faces(part), _load_facets(facets[part])
            )
            for part, name in enumerate(surface.parts)
        }
        self.scene = mi.load_dict({"type": "scene", **meshes}, parallel=False)
        self.isotropic = surface.isotropic
        # Hide the values of these numbers from Dr.Jit's compiler: it would compile a new kernel for
        # every specimen if they were literals
        self.side = dr.opaque(mi.Float, len(surface.heights))
        self.bottom = dr.opaque(mi.Float, surface.heights.min())
        self.top = dr.opaque(mi.Float, surface.heights.max())

    def draw_samples(self, wi: FloatArray, wo: FloatArray, pair: IntArray, seed: int) -> FloatArray:
        """Draw n samples of the BRDF [sr⁻¹] in R, G and B, (n, 3), whose mean is the BRDF.

        `wi` and `wo` are m pairs of unit vectors (m, 3) above the plane, and `pair` (n,) is the row
        of the pair for each sample. `seed` is from 0 to 2³² - 1. An isotropic surface is turned to
        a random azimuth for every sample, and mirrored for half of them.
        """
        import mitsuba as mi

        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, len(pair))
        rows = mi.UInt32(pad(pair.astype(np.uint32)))
        light, eye = (
            dr.gather(mi.Vector3f, mi.Vector3f(w.T.astype(np.float32)), rows) for w in (wi, wo)
        )
        if self.isotropic:
            light, eye = _rotate_at_random(sampler, light, eye)
        radiance = self._trace_paths(light, eye, sampler, dr.opaque(mi.UInt32, self.max_bounces))
        return np.array(radiance / light.z, np.float64).T

    @dr.syntax
    def _trace_paths(
        self, wi: JitVector, wo: JitVector, sampler: MitsubaObject, bounces: JitInt
    ) -> JitColour:
        """Trace a path from a random line towards wo, and return its radiance.

        The light from wi has the irradiance E = 1 across its beam.
        """
        import mitsuba as mi

        # The path begins above the surface, over a random point of the tile
        context = mi.BSDFContext()
        xy = (sampler.next_2d() - 0.5) * self.side
        ray = mi.Ray3f(mi.Point3f(xy.x, xy.y, self.top + 1), -wo)
        radiance, throughput = mi.Color3f(0), mi.Color3f(1)
        active = mi.Bool(True)
        while active:
            si = self._find_first_hit(mi.Ray3f(ray), mi.Bool(active))
            active &= si.is_valid()

            # Add the light that the facet reflects, unless another facet is in its way
            bsdf = si.bsdf()
            scattered = bsdf.eval(context, si, si.to_local(wi), active)
            lit = active & dr.any(scattered != 0)
            start = si.p + RAY_OFFSET * si.n
            shadow = self._find_first_hit(mi.Ray3f(start, wi), mi.Bool(lit)).is_valid()
            radiance += dr.select(lit & ~shadow, throughput * scattered, 0)

            # Continue the path in a direction that the BSDF draws
            sample, weight = bsdf.sample(
                context, si, sampler.next_1d(active), sampler.next_2d(active), active
            )
            throughput *= weight
            ray = mi.Ray3f(start, si.to_world(sample.wo))
            bounces -= 1
            active &= (bounces > 0) & dr.any(throughput != 0)
        return radiance

    @dr.syntax
    def _find_first_hit(self, ray: MitsubaObject, active: JitMask) -> MitsubaObject:
        """Return the surface interaction at a ray's first hit on the endless surface.

        Its point lies in the central tile, to which the whole path is translated.
        """
        import mitsuba as mi

        hit: Any = dr.zeros(mi.PreliminaryIntersection3f)
        hit.t = dr.inf
        tiles = mi.UInt32(0)
        while active:
            hit = self.scene.ray_intersect_preliminary(ray, active=active)

            # Find the point where the ray leaves the tile sideways: its origin if it starts outside
            side_x, side_y = dr.copysign(self.side, ray.d.x), dr.copysign(self.side, ray.d.y)
            to_x = (side_x / 2 - ray.o.x) / ray.d.x
            to_y = (side_y / 2 - ray.o.y) / ray.d.y
            wall = ray(dr.maximum(dr.minimum(to_x, to_y), 0))

            # End rays that hit the surface, or that leave the range of the surface's heights
            above = (wall.z > self.top) & (ray.d.z > 0)
            below = (wall.z < self.bottom) & (ray.d.z < 0)
            tiles += 1
            active &= ~hit.is_valid() & ~above & ~below & (tiles < MOST_TILES)

            # Let all other rays enter the tile again on the opposite side
            wall.x -= dr.select(to_x <= to_y, side_x, 0)
            wall.y -= dr.select(to_y < to_x, side_y, 0)
            ray.o = dr.select(active, wall, ray.o)
        return hit.compute_surface_interaction(ray)


def _import_mitsuba() -> MitsubaModule:
    """Import Mitsuba, and return it; raise `BrdfkitError` in a scalar or spectral variant."""
    import mitsuba as mi

    variant = use_variant()
    if variant.startswith("scalar") or not variant.endswith("_rgb"):
        raise BrdfkitError(
            f"The goniometer does not work in Mitsuba's variant {variant}; "
            "set llvm_ad_rgb or cuda_ad_rgb."
        )
    return mi


def _load_facets(facets: dict[str, Any]) -> MitsubaObject:
    """Load the BSDF of facets; raise `BrdfkitError` for a mirror, or if it lets light through."""
    import mitsuba as mi

    try:
        bsdf = mi.load_dict(facets, parallel=False)
    except (RuntimeError, TypeError) as error:
        reason = str(error).rpartition("] ")[2].rstrip(".!")
        raise BrdfkitError(f"Mitsuba cannot load the facets {facets} ({reason}).") from error
    unfit = mi.BSDFFlags.Delta | mi.BSDFFlags.Transmission | mi.BSDFFlags.Null
    if bsdf.flags() & unfit:
        raise BrdfkitError(
            f"The facets {facets} are a mirror or let light through; take rough, opaque ones."
        )
    return bsdf


def _make_mesh(
    name: str, vertices: FloatArray, faces: IntArray, bsdf: MitsubaObject
) -> MitsubaObject:
    """Make a Mitsuba mesh of flat triangles from `vertices` (n, 3) and `faces` (m, 3)."""
    import mitsuba as mi

    properties = mi.Properties()
    properties["bsdf"] = bsdf
    mesh = mi.Mesh(name, len(vertices), len(faces), properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = mi.Float(pad(vertices.ravel().astype(np.float32)))
    parameters["faces"] = mi.UInt32(pad(faces.ravel().astype(np.uint32)))
    parameters.update()
    return mesh


def _rotate_at_random(sampler: MitsubaObject, wi: JitVector, wo: JitVector) -> list[JitVector]:
    """Rotate each pair of directions about the normal at random, and mirror half of the pairs."""
    import mitsuba as mi

    s, c = dr.sincos(2 * dr.pi * sampler.next_1d())
    mirror = dr.select(sampler.next_1d() < 0.5, 1, -1)
    return [mi.Vector3f(c * w.x - s * w.y, mirror * (s * w.x + c * w.y), w.z) for w in (wi, wo)]
