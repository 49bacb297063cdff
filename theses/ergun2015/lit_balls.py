"""What the experiments with lobes share: the material, the methods, a picture and its errors."""

import time

import numpy as np
from brdfkit.theses.ergun2015.unshadowed import unshadowed

from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.environments.map_files import load_map
from brdfkit.rendering.previewing.scene import describe_preview
from brdfkit.rendering.scene_input.material import load_material

PROBES = "grace", "uffizi", "pisa", "ennis"
SHIPPED = "studio", "sky", "room"


def find_probes(sources):
    """Name → file of the thesis's probes where all are at hand, else name → name of the maps that
    brdfkit brings."""
    files = {name: sources.find_beside(f"environments/{name}.hdr") for name in PROBES}
    return files if all(files.values()) else {name: name for name in SHIPPED}


def read_probes(sources):
    """Name → radiance (height, width, 3) of each of the probes."""
    return {name: load_map(file)[1].astype(float) for name, file in find_probes(sources).items()}


METHODS = "gmm", "kde", "warped", "filtered_sampling"
FILTERS = "mips", "lobes"
ROUGHNESSES = 0.01, 0.05, 0.1, 0.15, 0.2
WARD = {"type": "ward", "diffuse_reflectance": 0.1, "specular_reflectance": 0.4}
SIZE, SAMPLES = 96, 4096


def material(alpha):
    """The BSDF of Ward's lobe of a roughness."""
    return load_material(WARD | {"alpha_u": alpha, "alpha_v": alpha}, "ward", both_sides=True)


def integrators():
    """(method, filter) → integrator; both filters of a method share its lobes, and all methods of a
    filter its light."""
    import mitsuba as mi

    found = {}
    for method in METHODS:
        for filter_ in FILTERS:
            entries = {"type": "filtered_environment", "method": method, "filter": filter_}
            made = found[method, filter_] = mi.load_dict(entries)
            made.light = found[METHODS[0], filter_].light
            made.shading = found[method, FILTERS[0]].shading
    return found


def render(made, light, integrator):
    """(picture, seconds of CPU, scene) of a scene's dictionary, a ray through the middle of each
    pixel."""
    import mitsuba as mi

    scene = mi.load_dict(describe_preview(made, light, integrator, 1), parallel=False)
    start = time.process_time()
    picture = np.array(integrator.render(scene, seed=0, spp=1), float)[..., :3]
    return picture, time.process_time() - start, scene


def truth(made, light):
    """(the picture by samples, in two halves; the scene)."""
    halves = [render(made, light, unshadowed(SAMPLES // 2, seed)) for seed in (1, 2)]
    return [half[0] for half in halves], halves[0][2]


def decibels(reference, picture, seen):
    """PSNR over the pixels `seen`: of 8-bit sRGB with the peak 255, and of linear values."""
    eight_bits = (np.round(255 * to_srgb(p)) for p in (reference, picture))
    return psnr(*eight_bits, seen, peak=255), psnr(reference, picture, seen)
