"""Defines the material, the methods, the pictures and their errors for all claims on lobes."""

import time

import numpy as np
from brdfkit.theses.ergun2015.unshadowed import make_unshadowed_integrator

from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.environments.map_files import load_map
from brdfkit.rendering.previewing.scene import describe_preview
from brdfkit.rendering.scene_input.material import load_material
from brdfkit.theses.replacing import replace_part

PROBES = "grace", "uffizi", "pisa", "ennis"
SHIPPED = "studio", "sky", "room"


def find_probes(sources):
    """Return the file of each of the thesis's probes by name, or shipped maps if one is missing."""
    files = {name: sources.find_beside(f"environments/{name}.hdr") for name in PROBES}
    return files if all(files.values()) else {name: name for name in SHIPPED}


def read_probes(sources):
    """Return the radiance (height, width, 3) of each probe by name."""
    return {name: load_map(file)[1].astype(float) for name, file in find_probes(sources).items()}


METHODS = "gmm", "kde", "warped", "filtered_sampling"
FILTERS = "mips", "lobes"
ROUGHNESSES = 0.01, 0.05, 0.1, 0.15, 0.2
WARD = {"type": "ward", "diffuse_reflectance": 0.1, "specular_reflectance": 0.4}
SIZE, SAMPLES = 96, 4096


def make_ward_bsdf(alpha):
    """Return the BSDF of Ward's lobe of a roughness."""
    return load_material(WARD | {"alpha_u": alpha, "alpha_v": alpha}, "ward", both_sides=True)


def make_integrators():
    """Return an integrator for each method and filter of the map.

    Both filters of a method share its fitted lobes, and all methods of a filter its filtered map.
    """
    import mitsuba as mi

    found = {}
    for method in METHODS:
        for filter_ in FILTERS:
            entries = {"type": "filtered_environment", "method": method, "filter": filter_}
            made = found[method, filter_] = mi.load_dict(entries)
            made.light = found[METHODS[0], filter_].light
            made.shading = found[method, FILTERS[0]].shading
    return found


def render_scene(made, light, integrator):
    """Render a scene's dictionary with a ray through the middle of each pixel.

    Returns the picture, the CPU seconds and the scene.
    """
    import mitsuba as mi

    scene = mi.load_dict(describe_preview(made, light, integrator, 1), parallel=False)
    start = time.process_time()
    picture = np.array(integrator.render(scene, seed=0, spp=1), float)[..., :3]
    return picture, time.process_time() - start, scene


def render_filtered(made, light, integrator):
    """Render like `render_scene` by one of the integrators of `make_integrators`."""
    parts = (integrator.light, "filter_if_changed"), (integrator.shading, "radiance")
    with replace_part(*parts[0]), replace_part(*parts[1]):  # the shared parts are those in use
        return render_scene(made, light, integrator)


def render_reference(made, light):
    """Render the picture by many samples in two halves, and return them with the scene."""
    halves = [
        render_scene(made, light, make_unshadowed_integrator(SAMPLES // 2, seed)) for seed in (1, 2)
    ]
    return [half[0] for half in halves], halves[0][2]


def compute_psnr(reference, picture, seen):
    """Return the PSNR over the pixels `seen`, of 8-bit sRGB and of linear values."""
    eight_bits = (np.round(255 * to_srgb(p)) for p in (reference, picture))
    return psnr(*eight_bits, seen, peak=255), psnr(reference, picture, seen)
