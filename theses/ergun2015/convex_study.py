"""Renders a mesh on a ground under the environment `studio`, with shadows of several kinds.

All pictures take the same samples, by the integrator `convex_direct`: they differ by their shadows
alone.
"""

import copy
from contextlib import nullcontext
from functools import cache, cached_property
from importlib.util import find_spec

import numpy as np
from brdfkit.theses.ergun2015.convex_rays import ExactPlaneMap
from brdfkit.theses.ergun2015.height_fields import HeightFields
from brdfkit.theses.ergun2015.printed_ray import PrintedOccluders
from brdfkit.theses.ergun2015.shapes import find_meshes

from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.visibility.decomposition import decompose
from brdfkit.lighting.visibility.occluders import Occluders
from brdfkit.rendering.scene_input.environment import describe_environment, replace_light
from brdfkit.theses.replacing import replace_part

SIZE, SPP = 96, 64
EPSILON = 1e-5  # over a part's radius, of Algorithm 3: exact with true planes
SWEPT = "spot"  # the mesh for which settings are varied, and which moves
GREY = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": 0.5}}
SETTING = f"""Pictures of {SIZE} × {SIZE} pixels with {SPP} samples: a grey mesh, whose longest side
is 2, on a ground under the environment *studio*. The truth has the shadows of its triangles."""
PRINTED_FORM = f"""*Printed*: parts lie in spheres, rays meet them by Algorithm 3 with ε =
{EPSILON:g}, and nothing has the clearance that brdfkit adds: parts and fields shade from the
surface on."""
NO_COACD = (
    "coacd or libigl is not installed, which find the parts; pip install 'brdfkit[visibility]'."
)


@cache
def make_studies(sources):
    """Return a `Study` by name for each mesh that encloses a volume, made once for all parts."""
    found = {name: Study(shape) for name, shape in find_meshes(sources).items()}
    return {name: study for name, study in found.items() if study.decompose_mesh()}


def make_swept_study(sources):
    """Return the name and the `Study` of the mesh for which settings are varied."""
    ((name, shape),) = find_meshes(sources, [SWEPT]).items()
    return name, Study(shape)


def can_decompose():
    """Return whether the packages that decompose meshes are installed."""
    return all(find_spec(name) for name in ("coacd", "igl"))


class Study:
    """A mesh, given as a `Shape`, with its pictures by shadows of several kinds.

    It has a `bsdf` and stands in the environment `light`, a map of brdfkit's or a file.
    """

    def __init__(self, shape, bsdf=GREY, light="studio"):
        import mitsuba as mi

        self.points, self.faces = shape.points, shape.faces
        made = shape.build(bsdf, (SIZE, SIZE))
        light = describe_environment(light) | {"type": "kdtree_envmap"}
        entries = replace_light(light, made) | {"integrator": {"type": "convex_direct"}}
        self.scene = mi.load_dict(entries, parallel=False)
        self.ground = mi.load_dict({"type": "scene", "ground": made["ground"]}, parallel=False)

    def decompose_mesh(self, **settings):
        """Return the convex parts of the mesh; the settings are those of `decompose`."""
        return decompose(self.points, self.faces, **settings)

    @cached_property
    def convex(self):
        """The mesh as convex parts, by the default settings."""
        return Occluders({"mesh": self.decompose_mesh()})

    @cached_property
    def fields(self):
        """The mesh as height fields."""
        return HeightFields(self.points, self.faces)

    def make_printed_parts(self, true_planes=False):
        """Return the same parts as the thesis prints them, which do not know a clearance.

        Rays find the `true_planes` or those of texels.
        """
        parts = PrintedOccluders({"mesh": self.convex.hulls}, EPSILON)
        if true_planes:
            parts.maps = ExactPlaneMap(parts.hulls)
        return parts

    @cached_property
    def fields_without_clearance(self):
        """The mesh as height fields, which may block rays at once, as in the thesis."""
        fields = copy.copy(self.fields)
        fields.clearance = 0
        return fields

    @cached_property
    def exact(self):
        """The picture with the shadows of the mesh's triangles."""
        return self.render(None, self.scene)

    def render(self, occluders, others=None, spp=SPP):
        """Render a picture with the shadows of `occluders` and of the scene `others`.

        By default the other scene is the ground.
        """
        integrator = self.scene.integrator()
        integrator.casters.set_casters(self.scene, occluders, others or self.ground)
        with replace_part(occluders, "is_blocked") if occluders else nullcontext():
            return np.array(integrator.render(self.scene, seed=0, spp=spp), float)[..., :3]

    def compute_quality(self, occluders):
        """Return the PSNR [dB] of a picture with shadows of `occluders`, linear and in sRGB."""
        picture = self.render(occluders)
        on_screen = (to_screen_values(p, self.exact) for p in (self.exact, picture))
        return psnr(self.exact, picture), psnr(*on_screen, peak=1)

    def count_reads(self, occluders):
        """Return mean and deviation of the reads of maps per pixel, for two shadow rays."""
        counting = CountingOccluders(occluders)
        self.render(counting, spp=1)
        reads = sum(np.array(found, float) for found in counting.reads)
        return reads.mean(), reads.std()


class CountingOccluders:
    """Occluders that remember the reads of all rays, which Mitsuba's integrator does not return."""

    def __init__(self, occluders):
        self.occluders, self.reads = occluders, []

    def is_blocked(self, ray, active=True):
        """Return whether rays are blocked, and the reads, which are also remembered."""
        import drjit as dr

        blocked, reads = self.occluders.is_blocked(ray, active)
        dr.schedule(reads)
        self.reads.append(reads)
        return blocked, reads


def to_screen_values(picture, exact):
    """Return a picture in sRGB, with white at the 95th percentile of the `exact` one."""
    return to_srgb(picture / np.percentile(exact, 95))
