"""A specimen under the goniometer: microgeometry whose facets have BSDFs, and paths through it.

A directional light from wi, of irradiance E across its beam, falls on the plane of the mean height
with the irradiance E cosθ_i. The plane's radiance towards wo is the mean ⟨L⟩ over lines along wo
that are spread evenly over one tile of the plane. Hence

    f(wi, wo) = ⟨L⟩ / (E cosθ_i)
              = 1 / (A cosθ_i cosθ_o) ∫ f_facet (n·wi)⁺ (n·wo)⁺ V(wi) V(wo) dS + more bounces,

with A the area of the tile in the plane, S the surface, n its normal, and V = 1 where nothing is in
the way, else 0. One sample is one such line. A path follows it from above down to the surface, and
goes on by sampling the facets' BSDF; at every bounce a shadow ray tests whether the light is seen.

The tile repeats without end: a ray that leaves it sideways enters again on the other side.
"""

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.padding import pad

# Offset, along the normal, of rays that leave a point [grid cells]. With Mitsuba's own, 20 times
# larger, grazing light reaches 1 % too far; single precision needs about 1e-4 here.
LIFT = 1e-3
MOST_TILES = 1000  # tiles that a ray may cross; after them it counts as gone


class Specimen:
    """The triangles of a `HeightField` with Mitsuba BSDFs, in the current variant.

    `facets`: one BSDF's dictionary, or one for each of the surface's parts; `max_bounces`: light of
    longer paths is lost.
    """

    def __init__(self, surface, facets, max_bounces=8):
        mi = _mitsuba()
        facets = [facets] if isinstance(facets, dict) else list(facets)
        if len(facets) == 1:
            facets *= len(surface.parts)
        if len(facets) != len(surface.parts):
            raise BrdfkitError(
                f"{len(facets)} materials were given for {' and '.join(surface.parts)}; "
                "give one, or one for each."
            )
        if max_bounces < 1:
            raise BrdfkitError(f"max_bounces = {max_bounces} is out of bounds; give at least 1.")
        meshes = {
            name: _mesh(name, surface.vertices(), surface.faces(part), _bsdf(facets[part]))
            for part, name in enumerate(surface.parts)
        }
        self.scene = mi.load_dict({"type": "scene", **meshes}, parallel=False)
        self.isotropic, self.max_bounces = surface.isotropic, max_bounces
        # opaque to Dr.Jit: as literals in the kernel, every specimen would compile its own
        self.side = dr.opaque(mi.Float, len(surface.heights))
        self.bottom = dr.opaque(mi.Float, surface.heights.min())
        self.top = dr.opaque(mi.Float, surface.heights.max())

    def samples(self, wi, wo, pair, seed):
        """One sample (n, 3) of the BRDF in sr⁻¹ for each entry of `pair` (n,).

        `wi`, `wo`: (m, 3) unit vectors above the plane; `pair`: a row of both for each sample;
        `seed`: 0 to 2³² - 1. An isotropic surface is rotated to a random azimuth for every sample,
        and mirrored for half of them.
        """
        import mitsuba as mi

        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, len(pair))
        pair = mi.UInt32(pad(pair.astype(np.uint32)))
        wi, wo = (
            dr.gather(mi.Vector3f, mi.Vector3f(w.T.astype(np.float32)), pair) for w in (wi, wo)
        )
        if self.isotropic:
            wi, wo = _rotate_at_random(sampler, wi, wo)
        radiance = self._radiance(wi, wo, sampler, dr.opaque(mi.UInt32, self.max_bounces))
        return np.array(radiance / wi.z, float).T

    @dr.syntax
    def _radiance(self, wi, wo, sampler, bounces):
        """The radiance towards wo along one random line, of a light from wi with E = 1."""
        import mitsuba as mi

        # a line through a random point of the tile, from above the surface
        context = mi.BSDFContext()
        xy = (sampler.next_2d() - 0.5) * self.side
        ray = mi.Ray3f(mi.Point3f(xy.x, xy.y, self.top + 1), -wo)
        radiance, throughput = mi.Color3f(0), mi.Color3f(1)
        active = mi.Bool(True)
        while active:
            si = self._first_hit(mi.Ray3f(ray), mi.Bool(active))
            active &= si.is_valid()

            # the light, where nothing is in its way
            bsdf = si.bsdf()
            scattered = bsdf.eval(context, si, si.to_local(wi), active)
            lit = active & dr.any(scattered != 0)
            start = si.p + LIFT * si.n
            shadow = self._first_hit(mi.Ray3f(start, wi), mi.Bool(lit)).is_valid()
            radiance += dr.select(lit & ~shadow, throughput * scattered, 0)

            # the path goes on
            sample, weight = bsdf.sample(
                context, si, sampler.next_1d(active), sampler.next_2d(active), active
            )
            throughput *= weight
            ray = mi.Ray3f(start, si.to_world(sample.wo))
            bounces -= 1
            active &= (bounces > 0) & dr.any(throughput != 0)
        return radiance

    @dr.syntax
    def _first_hit(self, ray, active):
        """The surface interaction where a ray first meets the surface, in the central tile."""
        import mitsuba as mi

        found = dr.zeros(mi.PreliminaryIntersection3f)
        found.t = dr.inf
        tiles = mi.UInt32(0)
        while active:
            found = self.scene.ray_intersect_preliminary(ray, active=active)

            # where the ray crosses the wall of the tile; at once where it starts behind the wall
            side_x, side_y = dr.copysign(self.side, ray.d.x), dr.copysign(self.side, ray.d.y)
            to_x = (side_x / 2 - ray.o.x) / ray.d.x
            to_y = (side_y / 2 - ray.o.y) / ray.d.y
            wall = ray(dr.maximum(dr.minimum(to_x, to_y), 0))

            # done where it hits the surface, or leaves the range of its heights
            above = (wall.z > self.top) & (ray.d.z > 0)
            below = (wall.z < self.bottom) & (ray.d.z < 0)
            tiles += 1
            active &= ~found.is_valid() & ~above & ~below & (tiles < MOST_TILES)

            # elsewhere it enters the tile again through the opposite wall
            wall.x -= dr.select(to_x <= to_y, side_x, 0)
            wall.y -= dr.select(to_y < to_x, side_y, 0)
            ray.o = dr.select(active, wall, ray.o)
        return found.compute_surface_interaction(ray)


def _mitsuba():
    """The module `mitsuba`, in an RGB variant that traces many paths at once."""
    import mitsuba as mi

    variant = use_variant()
    if variant.startswith("scalar") or not variant.endswith("_rgb"):
        raise BrdfkitError(
            f"The goniometer does not work in Mitsuba's variant {variant}; "
            "set llvm_ad_rgb or cuda_ad_rgb."
        )
    return mi


def _bsdf(facets):
    """The Mitsuba BSDF of a dictionary; an error where a directional light cannot measure it."""
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


def _mesh(name, vertices, faces, bsdf):
    """A Mitsuba mesh of flat triangles."""
    import mitsuba as mi

    properties = mi.Properties()
    properties["bsdf"] = bsdf
    mesh = mi.Mesh(name, len(vertices), len(faces), properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = mi.Float(pad(vertices.ravel().astype(np.float32)))
    parameters["faces"] = mi.UInt32(pad(faces.ravel().astype(np.uint32)))
    parameters.update()
    return mesh


def _rotate_at_random(sampler, wi, wo):
    """Both directions in the frame of a tile at a random azimuth, mirrored with probability ½."""
    import mitsuba as mi

    s, c = dr.sincos(2 * dr.pi * sampler.next_1d())
    mirror = dr.select(sampler.next_1d() < 0.5, 1, -1)
    return [mi.Vector3f(c * w.x - s * w.y, mirror * (s * w.x + c * w.y), w.z) for w in (wi, wo)]
