"""A specimen under the goniometer: microgeometry with facets of a material, lit and seen.

A directional light from wi of irradiance E across its beam falls on the plane with E cosθ_i.
The plane's radiance towards wo is the mean over the lines along wo that cross one tile of the
plane evenly. So

    f(wi, wo) = ⟨L⟩ / (E cosθ_i)
              = 1 / (A cosθ_i cosθ_o) ∫ f_facet (n·wi)⁺ (n·wo)⁺ V(wi) V(wo) dS + more bounces,

A the area of the tile in the plane, S the surface, n its normal, V what is not in shadow. One
sample is one such line, followed from above down to the surface and on by sampling the facets'
BSDF; at every bounce a shadow ray asks for the light.

The tile repeats without end: what leaves it sideways comes in again on the other side.
"""

import drjit as dr
import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.llvm import use_variant
from brdfkit.padding import pad

# Rays leave a point so much above it, in grid cells. Mitsuba's own offset, 20 times this, lets
# grazing light reach 1 % too far; single precision asks for some 1e-4 here.
LIFT = 1e-3
MOST_TILES = 1000  # that one ray may cross; then it counts as gone


class Specimen:
    """The triangles of a `HeightField` with Mitsuba BSDFs, in the current variant.

    `facets`: one BSDF's dictionary, or one for each of the surface's parts; `max_bounces`:
    longer paths count as absorbed.
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
        # opaque numbers: as literals, each specimen would compile a kernel of its own
        self.side = dr.opaque(mi.Float, len(surface.heights))
        self.bottom = dr.opaque(mi.Float, surface.heights.min())
        self.top = dr.opaque(mi.Float, surface.heights.max())

    def samples(self, wi, wo, pair, seed):
        """One sample (n, 3) of the BRDF in sr⁻¹ for each entry of `pair` (n,).

        `wi`, `wo`: (m, 3) unit vectors above the plane; `pair`: indices of their rows; `seed`:
        0 to 2³² - 1. An isotropic patch lies at a random azimuth, mirrored in half of all cases.
        """
        import mitsuba as mi

        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, len(pair))
        pair = mi.UInt32(pad(pair.astype(np.uint32)))
        wi, wo = (
            dr.gather(mi.Vector3f, mi.Vector3f(w.T.astype(np.float32)), pair) for w in (wi, wo)
        )
        if self.isotropic:
            wi, wo = _turned(sampler, wi, wo)
        radiance = self._radiance(wi, wo, sampler, dr.opaque(mi.UInt32, self.max_bounces))
        return np.array(radiance / wi.z, float).T

    @dr.syntax
    def _radiance(self, wi, wo, sampler, bounces):
        """What one line along wo brings of a light from wi with E = 1."""
        import mitsuba as mi

        context = mi.BSDFContext()
        xy = (sampler.next_2d() - 0.5) * self.side
        ray = mi.Ray3f(mi.Point3f(xy.x, xy.y, self.top + 1), -wo)
        radiance, throughput = mi.Color3f(0), mi.Color3f(1)
        active = mi.Bool(True)
        while active:
            si = self._first_hit(mi.Ray3f(ray), mi.Bool(active))
            active &= si.is_valid()
            bsdf = si.bsdf()
            scattered = bsdf.eval(context, si, si.to_local(wi), active)
            lit = active & dr.any(scattered != 0)
            start = si.p + LIFT * si.n
            shadow = self._first_hit(mi.Ray3f(start, wi), mi.Bool(lit)).is_valid()
            radiance += dr.select(lit & ~shadow, throughput * scattered, 0)

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
        """Where a ray first meets the periodic surface, as if in the central tile."""
        import mitsuba as mi

        found = dr.zeros(mi.PreliminaryIntersection3f)
        found.t = dr.inf
        tiles = mi.UInt32(0)
        while active:
            found = self.scene.ray_intersect_preliminary(ray, active=active)
            # where the ray crosses the tile's wall; a start behind it crosses at once
            side_x, side_y = dr.copysign(self.side, ray.d.x), dr.copysign(self.side, ray.d.y)
            to_x = (side_x / 2 - ray.o.x) / ray.d.x
            to_y = (side_y / 2 - ray.o.y) / ray.d.y
            wall = ray(dr.maximum(dr.minimum(to_x, to_y), 0))
            above = (wall.z > self.top) & (ray.d.z > 0)
            below = (wall.z < self.bottom) & (ray.d.z < 0)
            tiles += 1
            active &= ~found.is_valid() & ~above & ~below & (tiles < MOST_TILES)
            wall.x -= dr.select(to_x <= to_y, side_x, 0)
            wall.y -= dr.select(to_y < to_x, side_y, 0)
            ray.o = dr.select(active, wall, ray.o)
        return found.compute_surface_interaction(ray)


def _mitsuba():
    """Mitsuba in a variant that traces many paths at once, in RGB."""
    import mitsuba as mi

    variant = use_variant()
    if variant.startswith("scalar") or not variant.endswith("_rgb"):
        raise BrdfkitError(
            f"The goniometer does not work in Mitsuba's variant {variant}; "
            "set llvm_ad_rgb or cuda_ad_rgb."
        )
    return mi


def _bsdf(facets):
    """A Mitsuba BSDF, once it is sure that light from one direction finds it."""
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
    """Flat triangles as a Mitsuba mesh."""
    import mitsuba as mi

    properties = mi.Properties()
    properties["bsdf"] = bsdf
    mesh = mi.Mesh(name, len(vertices), len(faces), properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = mi.Float(pad(vertices.ravel().astype(np.float32)))
    parameters["faces"] = mi.UInt32(pad(faces.ravel().astype(np.uint32)))
    parameters.update()
    return mesh


def _turned(sampler, wi, wo):
    """Both directions as a patch sees them that is turned, and mirrored, by chance."""
    import mitsuba as mi

    s, c = dr.sincos(2 * dr.pi * sampler.next_1d())
    mirror = dr.select(sampler.next_1d() < 0.5, 1, -1)
    return [mi.Vector3f(c * w.x - s * w.y, mirror * (s * w.x + c * w.y), w.z) for w in (wi, wo)]
