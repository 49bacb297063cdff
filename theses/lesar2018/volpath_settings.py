"""Defines ten settings in which `single_scattering` and Mitsuba's `volpath` show the same light."""

import time

import numpy as np
from brdfkit.theses.lesar2018.iterations import make_renderer

from brdfkit.lighting.sampling.emitter import make_small_sky
from brdfkit.volumes import TransferFunction

SIZE = 16  # pixels along the edges of a picture


def make_settings():
    """Return by name a function from an integrator's name to the dictionary of its scene.

    Lights: directions, points, spots, surfaces, environments. Media: even, of grids, coloured, by
        transfer functions; with surfaces in them and behind; scattering once and more. Two errors
        of `volpath` (Mitsuba 3.9.1) are left out. It loses the collisions nearer than 1.3e-4 to
        where rays enter a medium, for σ = 400 5 % of the light; and light of a sphere that shines
        from near, up to a tenth. `test_single_scattering.py` holds both to what they should be.
    """
    import mitsuba as mi

    t = mi.ScalarTransform4f
    sun = {"sun": {"type": "directional", "direction": [0.3, -1, 0.2], "irradiance": 2.0}}
    point = {"lamp": {"type": "point", "position": [1.6, 1.2, 0.4], "intensity": 3.0}}
    spot = {
        "lamp": {
            "type": "spot",
            "to_world": t().look_at([-0.5, 2, 0.5], [0.5, 0.5, 0.5], [0, 0, 1]),
            "intensity": 6.0,
        }
    }
    above = t().translate([0.5, 1.6, 0.5]).rotate([1, 0, 0], 90).scale(0.4)
    area = {"type": "area", "radiance": {"type": "rgb", "value": [6.0, 4.0, 2.0]}}
    panel = {"lamp": {"type": "rectangle", "to_world": above, "emitter": area}}
    beside = t().look_at([1.4, 1.2, 1.0], [0.5, 0.5, 0.5], [0, 1, 0]).scale(0.3)
    disk = {"lamp": {"type": "disk", "to_world": beside, "emitter": area}}
    even = {"sky": {"type": "constant", "radiance": 0.6}}
    map_of_mitsuba = {"sky": {"type": "envmap", "bitmap": make_small_sky()}}
    map_of_ours = {"sky": {"type": "kdtree_envmap", "bitmap": make_small_sky(), "blocks": 64}}
    ground = t().translate([0.5, 0.3, 0.5]).rotate([1, 0, 0], -90).scale(1.5)
    grey = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.6, 0.5, 0.4]}}
    surfaces = {
        "ground": {"type": "rectangle", "to_world": ground, "bsdf": grey},
        "ball": {"type": "sphere", "center": [0.5, 0.5, 0.5], "radius": 0.15, "bsdf": grey},
    }
    tinted = {"type": "constvolume", "value": {"type": "rgb", "value": [0.9, 0.5, 0.2]}}
    hg = {"type": "hg", "g": 0.6}
    plastic = {"type": "roughplastic", "alpha": 0.3}
    glossy = {"type": "bsdf_phase", "bsdf": plastic, "density": _make_grid(mi)}
    function = TransferFunction(
        [0, 2, 6], [[0.9, 0.3, 0.1, 0], [0.2, 0.8, 0.4, 0.2], [0.4, 0.4, 0.9, 1]], extinction=8
    )
    return {
        "even medium, sun": _make_setting(1.5, sun, phase=hg),
        "even medium, point": _make_setting(4.0, point, albedo=0.6),
        "grid, panel": _make_setting(_make_grid(mi), panel, phase=glossy),
        "grid, even sky": _make_setting(_make_grid(mi), even, phase={"type": "rayleigh"}),
        "grid, sky of Mitsuba's": _make_setting(
            _make_grid(mi), map_of_mitsuba, phase={"type": "schlick"}
        ),
        "grid, sky by blocks": _make_setting(
            _make_grid(mi), map_of_ours, phase={"type": "mie_hazy"}
        ),
        "coloured, spot and sky": _make_setting(
            _make_grid(mi), spot | even, albedo=tinted, phase=hg
        ),
        "half of a grid, disk": _make_setting(_make_grid(mi), disk, scale=0.5, albedo=tinted),
        "transfer function, surfaces": _make_setting(
            _make_grid(mi, values=True), sun | even | surfaces, function=function, phase=hg
        ),
        "scattered five times": _make_setting(
            _make_grid(mi), panel | even, albedo=tinted, phase=hg, scale=2.0, max_depth=6
        ),
    }


def _make_grid(mi, values=False):
    """Return a volume of random voxels in the unit cube, a third of them empty."""
    rng = np.random.default_rng(5)
    voxels = rng.uniform(0, 6, (7, 8, 9, 1)).astype(np.float32)
    voxels[voxels < 2] = 0
    return {"type": "gridvolume", "grid": mi.VolumeGrid(voxels), "raw": values}


def _make_setting(
    extinction, others, albedo=0.8, phase=None, function=None, scale=1.0, max_depth=2
):
    """Return a function from an integrator's name to the scene of a medium in the unit cube.

    `others` are further entries of the scene, such as lights.
    """
    phase = phase or {"type": "isotropic"}

    def make_scene(integrator):
        import mitsuba as mi

        t = mi.ScalarTransform4f
        camera = t().look_at([1.9, 1.1, 2.2], [0.5, 0.5, 0.5], [0, 1, 0])
        film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
        sensor = {"type": "perspective", "fov": 40, "to_world": camera, "film": film}
        sigma, colour = extinction, albedo
        if function is not None:
            sigma = {"type": "transfer_function", "values": sigma, "transfer": function.to_json()}
            colour = {**sigma, "output": "colour"}
        if integrator == "single_scattering":
            own = {"extinction": sigma, "albedo": 1.0 if function else colour}
            own |= {"type": integrator, "scale": scale, "phase": phase, "max_depth": max_depth}
            return {"type": "scene", "integrator": own, "sensor": sensor, **others}
        kind = "homogeneous" if isinstance(sigma, float) else "heterogeneous"
        medium = {"type": kind, "sigma_t": sigma, "albedo": colour, "scale": scale, "phase": phase}
        cube = {
            "type": "cube",
            "to_world": t().translate(0.5).scale(0.5),
            "bsdf": {"type": "null"},
            "interior": medium,
        }
        own = {"type": integrator, "max_depth": max_depth, "rr_depth": 1000}
        return {"type": "scene", "integrator": own, "sensor": sensor, "cube": cube, **others}

    return make_scene


def render_passes(scene, integrator, spp, passes=16, first=0):
    """Render pictures (passes, SIZE, SIZE, 3) with seeds from `first` on, and measure CPU seconds.

    scene : a value of `make_settings()`.
    spp : samples per pixel in each pass.
    """
    import mitsuba as mi

    render = make_renderer(spp)
    loaded, found, seconds = mi.load_dict(scene(integrator), parallel=False), [], []
    for seed in range(first, first + passes):
        start = time.process_time()
        found.append(np.array(render(loaded, seed), float))
        seconds.append(time.process_time() - start)
    return np.stack(found), np.array(seconds)


def compute_z_scores(ours, others, tiles=2):
    """Return the differences of two sets of pictures in standard errors, (tiles, tiles, 3).

    They are differences of the means of parts of the pictures. Pixels are taken to be independent,
    and their errors are found from the passes.
    """
    means, errors, edge = [], [], SIZE // tiles
    for found in (ours, others):
        parts = found.reshape(-1, tiles, edge, tiles, edge, 3)
        means.append(parts.mean(axis=(0, 2, 4)))
        variance = parts.var(axis=0, ddof=1) / len(found)
        errors.append(variance.sum(axis=(1, 3)) / edge**4)
    return (means[0] - means[1]) / np.sqrt(sum(errors))
