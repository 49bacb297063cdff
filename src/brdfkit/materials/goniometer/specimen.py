"""A specimen of the goniometer: microgeometry whose facets have BSDFs, and paths through it.

A directional light from wi, of irradiance E across its beam, falls on the plane of the mean height
with the irradiance E cosθ_i. The plane's radiance towards wo is the mean ⟨L⟩ over lines along wo
that are spread evenly over one tile of the plane. Hence

    f(wi, wo) = ⟨L⟩ / (E cosθ_i)
              = 1 / (A cosθ_i cosθ_o) ∫ f_facet (n·wi)⁺ (n·wo)⁺ V(wi) V(wo) dS + more bounces,

with A the area of the tile in the plane, S the surface, n its normal, and the visibility V = 1
where nothing is in the way, else 0. One sample is one such line. A path follows the line from above
down to the surface, and goes on by sampling the facets' BSDF; at every bounce a shadow ray tests
whether the light is visible.

The tile repeats without end: a ray that leaves it sideways enters again on the other side.
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

# Offset, along the normal, of rays that leave a point [grid cells]. With Mitsuba's own offset, 20
# times larger, grazing light reaches 1 % too far; single precision needs about 1e-4 here.
RAY_OFFSET = 1e-3
MOST_TILES = 1000  # tiles that a ray may cross; after them it misses the surface


class Specimen:
    """The triangles of a `HeightField` with Mitsuba BSDFs, in the current variant.

    `facets` is one BSDF's dictionary, or one for each of the surface's parts; the light of paths
    with more than `max_bounces` bounces is lost.
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
            name: _make_mesh(name, surface.vertices(), surface.faces(part), _load(facets[part]))
            for part, name in enumerate(surface.parts)
        }
        self.scene = mi.load_dict({"type": "scene", **meshes}, parallel=False)
        self.isotropic = surface.isotropic
        # Opaque to Dr.Jit: with literals in the kernel, every specimen would compile its own
        self.side = dr.opaque(mi.Float, len(surface.heights))
        self.bottom = dr.opaque(mi.Float, surface.heights.min())
        self.top = dr.opaque(mi.Float, surface.heights.max())

    def draw_samples(self, wi: FloatArray, wo: FloatArray, pair: IntArray, seed: int) -> FloatArray:
        """Draw one sample (n, 3) of the BRDF [sr⁻¹] for each entry of `pair` (n,).

        `wi` and `wo` are unit vectors (m, 3) above the plane, `pair` the row of both for each
        sample, and `seed` is from 0 to 2³² - 1. An isotropic surface is rotated to a random azimuth
        for every sample, and mirrored for half of them.
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
        radiance = self._trace(light, eye, sampler, dr.opaque(mi.UInt32, self.max_bounces))
        return np.array(radiance / light.z, np.float64).T

    @dr.syntax
    def _trace(
        self, wi: JitVector, wo: JitVector, sampler: MitsubaObject, bounces: JitInt
    ) -> JitColour:
        """Return the radiance towards wo along one random line, for a light from wi with E = 1."""
        import mitsuba as mi

        # A line through a random point of the tile, from above the surface
        context = mi.BSDFContext()
        xy = (sampler.next_2d() - 0.5) * self.side
        ray = mi.Ray3f(mi.Point3f(xy.x, xy.y, self.top + 1), -wo)
        radiance, throughput = mi.Color3f(0), mi.Color3f(1)
        active = mi.Bool(True)
        while active:
            si = self._find_first_hit(mi.Ray3f(ray), mi.Bool(active))
            active &= si.is_valid()

            # The light, where nothing is in its way
            bsdf = si.bsdf()
            scattered = bsdf.eval(context, si, si.to_local(wi), active)
            lit = active & dr.any(scattered != 0)
            start = si.p + RAY_OFFSET * si.n
            shadow = self._find_first_hit(mi.Ray3f(start, wi), mi.Bool(lit)).is_valid()
            radiance += dr.select(lit & ~shadow, throughput * scattered, 0)

            # The path goes on
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
        """Return the interaction where a ray first meets the surface, in the central tile."""
        import mitsuba as mi

        hit: Any = dr.zeros(mi.PreliminaryIntersection3f)
        hit.t = dr.inf
        tiles = mi.UInt32(0)
        while active:
            hit = self.scene.ray_intersect_preliminary(ray, active=active)

            # Where the ray crosses the wall of the tile; at once where it starts behind the wall
            side_x, side_y = dr.copysign(self.side, ray.d.x), dr.copysign(self.side, ray.d.y)
            to_x = (side_x / 2 - ray.o.x) / ray.d.x
            to_y = (side_y / 2 - ray.o.y) / ray.d.y
            wall = ray(dr.maximum(dr.minimum(to_x, to_y), 0))

            # Done where it hits the surface, or leaves the range of its heights
            above = (wall.z > self.top) & (ray.d.z > 0)
            below = (wall.z < self.bottom) & (ray.d.z < 0)
            tiles += 1
            active &= ~hit.is_valid() & ~above & ~below & (tiles < MOST_TILES)

            # Elsewhere it enters the tile again through the opposite wall
            wall.x -= dr.select(to_x <= to_y, side_x, 0)
            wall.y -= dr.select(to_y < to_x, side_y, 0)
            ray.o = dr.select(active, wall, ray.o)
        return hit.compute_surface_interaction(ray)


def _import_mitsuba() -> MitsubaModule:
    """Return the module `mitsuba`, in an RGB variant that traces many paths at once."""
    import mitsuba as mi

    variant = use_variant()
    if variant.startswith("scalar") or not variant.endswith("_rgb"):
        raise BrdfkitError(
            f"The goniometer does not work in Mitsuba's variant {variant}; "
            "set llvm_ad_rgb or cuda_ad_rgb."
        )
    return mi


def _load(facets: dict[str, Any]) -> MitsubaObject:
    """Load a BSDF; raise `BrdfkitError` if a directional light cannot measure it."""
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
    """Make a Mitsuba mesh of flat triangles."""
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
    """Return both directions in the frame of a randomly turned, or also mirrored, tile."""
    import mitsuba as mi

    s, c = dr.sincos(2 * dr.pi * sampler.next_1d())
    mirror = dr.select(sampler.next_1d() < 0.5, 1, -1)
    return [mi.Vector3f(c * w.x - s * w.y, mirror * (s * w.x + c * w.y), w.z) for w in (wi, wo)]
