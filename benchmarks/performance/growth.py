"""Cases whose cost grows: triangles of a mesh, voxels of a volume, lamps of a scene."""

from functools import cache, partial

import numpy as np

import brdfkit as bk

from .rows import LAMPS, TRIANGLES, VOXELS

SIDE = 512  # pixels of the pictures of meshes
VOLUME_SIDE, VOLUME_SPP = 128, 16
GLOW_SIDE, GLOW_SPP = 128, 4
LAMPS_SIDE, LAMPS_SPP = 64, 4
GREY = {"type": "diffuse", "reflectance": 0.5}


def load_mitsuba():
    """Return Mitsuba, in the variant that brdfkit chooses."""
    from brdfkit.core.jit import llvm

    llvm.use_variant()
    import mitsuba as mi

    return mi


def make_sensor(mi, side, eye, target, fov=40, **sampler):
    """Return the dictionary of a camera; z is up."""
    film = {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}}
    view = mi.ScalarTransform4f().look_at(eye, target, [0, 0, 1])
    return {"type": "perspective", "fov": fov, "to_world": view, "film": film, **sampler}


def render(mi, scene, integrator, spp):
    """Render a picture, and wait until it is there."""
    np.array(mi.render(scene, integrator=integrator, spp=spp))


# Triangles


@cache
def load_mesh(count):
    """Return a scene of about `count` triangles, hills over a square of side 4, under a sun."""
    mi = load_mitsuba()
    from brdfkit.rendering.scenes._meshes import make_grid_mesh

    n = round((count / 2) ** 0.5) + 1
    x, y = np.meshgrid(*[np.linspace(-2, 2, n, dtype=np.float32)] * 2)
    z = 0.2 * np.sin(5 * x) * np.cos(4 * y) + 0.02 * np.sin(40 * x + 30 * y)
    slope_x = np.cos(5 * x) * np.cos(4 * y) + 0.8 * np.cos(40 * x + 30 * y)
    slope_y = -0.8 * np.sin(5 * x) * np.sin(4 * y) + 0.6 * np.cos(40 * x + 30 * y)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(x)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    mesh = make_grid_mesh(np.stack([x, y, z], axis=-1), normals, bk.models()["ggx"]().scene_dict())
    return mi.load_dict(
        {
            "type": "scene",
            "sensor": make_sensor(mi, SIDE, [0, -5, 4], [0, 0, 0]),
            "mesh": mesh,
            "sun": {"type": "directional", "direction": [0.8, 0.3, -0.6], "irradiance": 3.0},
        }
    )


def prepare_shadow_rays(count):
    """Return Mitsuba's rays to the sun, one from each pixel's surface."""
    import drjit as dr

    scene, mi = load_mesh(count), load_mitsuba()
    index = dr.arange(mi.UInt32, SIDE**2)
    pixel = (mi.Point2f(mi.Float(index % SIDE), mi.Float(index // SIDE)) + 0.5) / SIDE
    seen = scene.ray_intersect(scene.sensors()[0].sample_ray(0.0, 0.5, pixel, mi.Point2f(0.5))[0])
    light, _ = scene.emitters()[0].sample_direction(seen, mi.Point2f(0.5))
    ray = seen.spawn_ray(light.d)
    dr.eval(ray)

    def test_rays():
        dr.eval(scene.ray_test(ray))
        dr.sync_thread()

    return test_rays


def prepare_mesh_picture(count, **integrator):
    """Return a picture of the mesh, a sample for each pixel."""
    scene, mi = load_mesh(count), load_mitsuba()
    return partial(render, mi, scene, mi.load_dict(integrator), 1)


MESH_PICTURES = {
    "path": {"type": "path", "max_depth": 2},
    "shadow_map": {"type": "shadow_map"},
}


# Voxels


def make_density(mi, n):
    """Return a Mitsuba volume of n³ voxels in the unit cube: a cloud of waves, half of it empty."""
    x = np.linspace(0, 1, n, dtype=np.float32)
    a, b, c = (np.sin(k * np.pi * x) for k in (3, 5, 4))
    waves = a[:, None, None] * b[:, None] * c + 0.3 * np.sin(31 * x)[:, None]
    return {"type": "gridvolume", "grid": mi.VolumeGrid(np.maximum(8 * waves, 0)[..., None])}


def prepare_volume(n, integrator):
    """Return a picture of a volume, lit by a sun and a sky, by an integrator."""
    mi = load_mitsuba()
    density, t = make_density(mi, n), mi.ScalarTransform4f()
    scene = {
        "type": "scene",
        "sun": {"type": "directional", "direction": [0.3, 0.2, -1], "irradiance": 2.0},
        "sky": {"type": "constant", "radiance": 0.4},
    }
    side, spp = (GLOW_SIDE, GLOW_SPP) if integrator == "glow" else (VOLUME_SIDE, VOLUME_SPP)
    scene["sensor"] = make_sensor(mi, side, [1.9, -1.2, 1.4], [0.5, 0.5, 0.5])
    if integrator == "volpath":
        medium = {"type": "heterogeneous", "sigma_t": density, "albedo": 0.8}
        cube = {"type": "cube", "to_world": t.translate(0.5).scale(0.5), "bsdf": {"type": "null"}}
        scene["cube"] = cube | {"interior": medium}
        own = {"type": "volpath", "max_depth": 2, "rr_depth": 1000}
    elif integrator == "glow":
        own = {"type": "emission_absorption", "extinction": density, "steps": n}
    else:
        own = {"type": "single_scattering", "extinction": density, "albedo": 0.8}
    loaded = mi.load_dict(scene | {"integrator": own})
    return partial(render, mi, loaded, loaded.integrator(), spp)


# Lamps


def prepare_lamps(count, integrator):
    """Return a picture of a box on the ground under glowing balls; Mitsuba's `path`, or ours."""
    mi = load_mitsuba()
    random = np.random.default_rng(0)
    lamps = {
        f"lamp_{k}": {
            "type": "sphere",
            "center": random.uniform((-3, -3, 3), (3, 3, 4)).tolist(),
            "radius": 0.1,
            "emitter": {"type": "area", "radiance": 10.0},
        }
        for k in range(count)
    }
    scene = {"type": "scene", "sensor": make_sensor(mi, LAMPS_SIDE, [4, -5, 4], [0, 0, 0.5])}
    t = mi.ScalarTransform4f()
    if integrator == "path":
        own = {"type": "path", "max_depth": 2}
        scene["ground"] = {"type": "rectangle", "to_world": t.scale(50), "bsdf": GREY}
        scene["box"] = {"type": "cube", "to_world": t.translate([0, 0, 0.7]).scale(0.7)}
    else:
        from brdfkit.distance_fields import box, plane

        field = plane() | box(0.7).at(0, 0, 0.7)
        own = {"type": "distance_field", "bsdf": GREY, "field": field.to_json()}
    loaded = mi.load_dict(scene | lamps | {"integrator": own})
    return partial(render, mi, loaded, loaded.integrator(), LAMPS_SPP)


CASES = {}
for count in TRIANGLES:
    CASES[f"triangles {count}: ray_test"] = partial(prepare_shadow_rays, count)
    for name, settings in MESH_PICTURES.items():
        CASES[f"triangles {count}: {name}"] = partial(prepare_mesh_picture, count, **settings)
for n in VOXELS:
    for name in ("single_scattering", "volpath", "glow"):
        CASES[f"voxels {n}: {name}"] = partial(prepare_volume, n, name)
for count in LAMPS:
    for name in ("distance_field", "path"):
        CASES[f"lamps {count}: {name}"] = partial(prepare_lamps, count, name)
