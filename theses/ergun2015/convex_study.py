"""A mesh on a ground under the environment `studio`, with shadows of several kinds.

All pictures take the same samples, by the integrator `convex_direct`: they differ by their shadows
alone.
"""

from functools import cache, cached_property
from importlib.util import find_spec

import numpy as np
from brdfkit.theses.ergun2015.height_fields import HeightFields
from brdfkit.theses.ergun2015.shapes import find_meshes

from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.visibility.decomposition import decompose
from brdfkit.lighting.visibility.occluders import Occluders
from brdfkit.rendering.scene_input.environment import describe_environment, replace_light
from brdfkit.theses.claims import measure_least_seconds

SIZE, SPP = 96, 64
SWEPT = "spot"  # the mesh of which settings are varied, and that moves
GREY = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": 0.5}}
SETTING = f"""Pictures of {SIZE} × {SIZE} pixels with {SPP} samples: a grey mesh, whose longest side
is 2, on a ground under the environment *studio*. The truth has the shadows of its triangles."""
NO_COACD = (
    "coacd or libigl is not installed, which find the parts; pip install 'brdfkit[visibility]'."
)


@cache
def studies(sources):
    """Name → `Study` of the meshes that enclose a volume; made once for all parts of the page."""
    found = {name: Study(shape) for name, shape in find_meshes(sources).items()}
    return {name: study for name, study in found.items() if study.parts()}


def swept(sources):
    """(name, `Study`) of the mesh of which settings are varied."""
    ((name, shape),) = find_meshes(sources, [SWEPT]).items()
    return name, Study(shape)


def has_coacd():
    """Whether meshes can be decomposed here."""
    return all(find_spec(name) for name in ("coacd", "igl"))


class Study:
    """A mesh, and its pictures; `shape`: a `Shape`."""

    def __init__(self, shape):
        import mitsuba as mi

        self.points, self.faces = shape.points, shape.faces
        made = shape.build(GREY, (SIZE, SIZE))
        light = describe_environment("studio") | {"type": "kdtree_envmap"}
        entries = replace_light(light, made) | {"integrator": {"type": "convex_direct"}}
        self.scene = mi.load_dict(entries, parallel=False)
        self.ground = mi.load_dict({"type": "scene", "ground": made["ground"]}, parallel=False)

    def parts(self, **settings):
        """The convex parts of the mesh; see `decompose`."""
        return decompose(self.points, self.faces, **settings)

    @cached_property
    def convex(self):
        """The mesh as convex parts, by the default settings."""
        return Occluders({"mesh": self.parts()})

    @cached_property
    def fields(self):
        """The mesh as height fields."""
        return HeightFields(self.points, self.faces)

    @cached_property
    def exact(self):
        """The picture with the shadows of triangles."""
        return self.render(None, self.scene)

    def render(self, occluders, others=None, spp=SPP):
        """A picture with the shadows of `occluders`, and of the scene `others`: by default of the
        ground."""
        integrator = self.scene.integrator()
        integrator.casters.set_casters(self.scene, occluders, others or self.ground)
        return np.array(integrator.render(self.scene, seed=0, spp=spp), float)[..., :3]

    def seconds(self, occluders):
        """Seconds of CPU for a picture, the least of three."""
        return measure_least_seconds(self.render, occluders)

    def quality(self, occluders):
        """PSNR [dB] of the picture with the shadows of `occluders`: (linear, as shown)."""
        picture = self.render(occluders)
        on_screen = (shown(p, self.exact) for p in (self.exact, picture))
        return psnr(self.exact, picture), psnr(*on_screen, peak=1)

    def reads(self, occluders):
        """Reads of maps per pixel, for the two shadow rays of one sample: (mean, deviation)."""
        counting = Counting(occluders)
        self.render(counting, spp=1)
        reads = sum(np.array(found, float) for found in counting.reads)
        return reads.mean(), reads.std()


class Counting:
    """Occluders that remember the reads of all rays."""

    def __init__(self, occluders):
        self.occluders, self.reads = occluders, []

    def is_blocked(self, ray, active=True):
        """As that of the occluders."""
        import drjit as dr

        blocked, reads = self.occluders.is_blocked(ray, active)
        dr.schedule(reads)
        self.reads.append(reads)
        return blocked, reads


def shown(picture, exact):
    """A picture as it is shown: in sRGB, with white at the 95th percentile of the `exact` one."""
    return to_srgb(picture / np.percentile(exact, 95))
